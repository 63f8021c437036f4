// SPDX-License-Identifier: Apache-2.0
// What a joint's loop of disturbance observer and law is worth: the sampled loop as a linear system, its
// sensitivity and what the sensor's noise makes of it.
#pragma once

namespace telekerf::control {

/// What bounds the loop of a joint.
struct LoopConditions {
  double period_s = 1e-3;
  double delay_s = 0.0;             ///< age of a reading when the force that answers it begins to act
  double noise_m = 0.0;             ///< rms of a reading's error
  double max_noise_m_per_s2 = 1e9;  ///< rms that this noise may make of the acceleration asked for
};

/// The three bandwidths of a loop, rad/s.
struct LoopBandwidths {
  double law_rad_per_s = 0.0;       ///< w of a'' = -2 w v - w^2 x, sampled poles
  double observer_rad_per_s = 0.0;  ///< of the disturbance estimate
  double velocity_rad_per_s = 0.0;  ///< of the velocity estimate
};

/// What a loop is worth on a joint whose inertia over force constant is `inertia_ratio` times the file's.
struct LoopMargins {
  bool stable = false;
  double max_sensitivity = 0.0;  ///< largest |S| = |1 / (1 + L)|, at the motor's force; 1 / modulus margin
  double noise_m_per_s2 = 0.0;   ///< rms of the acceleration asked for, by the sensor's noise
  double noise_m_per_s = 0.0;    ///< rms of the joint's true velocity, likewise; at the file's inertia
};
LoopMargins loop_margins(const LoopConditions& conditions, const LoopBandwidths& bandwidths,
                         double inertia_ratio = 1.0);

}  // namespace telekerf::control
