// SPDX-License-Identifier: Apache-2.0
// How a path is followed: rates, bandwidths, and how much of the robot's file is used.
#pragma once

#include <algorithm>
#include <cstdint>

namespace telekerf::machining {

/// What of the robot's file is used beside feedback.
enum class ModelUse : std::uint8_t {
  kNone,    ///< the joints' masses at the start (eq. 21); all else is left to the observer
  kJoints,  ///< every joint for itself: also its friction and its weight at the start, and preview
  kWhole,   ///< A(q), weight, Coriolis force and friction
};

struct PathFollowerSettings {
  double control_hz = 2400.0;
  int loop_delay = 0;                 ///< samples from a reading to the effect of its currents
  bool preview = true;                ///< false: accelerations of the same tick, as if the loop had no delay
  double along_rad_s = 70.0;          ///< bandwidth of all joints, or along the path
  double across_rad_s = 240.0;        ///< contouring: across the path
  double observer_rad_s = 400.0;      ///< of the disturbance
  double velocity_rad_s = 900.0;      ///< of the velocity estimate
  ModelUse model = ModelUse::kWhole;  ///< preview, contouring
  ModelUse independent_model = ModelUse::kNone;  ///< as in the thesis (eq. 21, 32)

  /// Bandwidths of the observer that fit a speed: sensor noise makes the same ripple in m/s at any speed, so
  /// slow paths get a quieter loop; there friction changes its direction more slowly, too. `stiff` keeps the
  /// observer faster than that: at corners friction changes at once, and an even burn matters more than
  /// ripple.
  void tune_for_speed(double speed_m_per_s, bool stiff = false) noexcept {
    observer_rad_s = std::clamp(37.5e3 * speed_m_per_s, stiff ? 200.0 : 60.0, 400.0);
    velocity_rad_s = std::clamp(112.5e3 * speed_m_per_s, stiff ? 600.0 : 220.0, 900.0);
    along_rad_s = std::clamp(20.0 + 17.5e3 * speed_m_per_s, 50.0, 70.0);
  }
};

}  // namespace telekerf::machining
