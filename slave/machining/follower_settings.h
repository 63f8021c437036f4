// SPDX-License-Identifier: Apache-2.0
// How a path is followed: rates, bandwidths, and how much of the robot's file is used.
#pragma once

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
  double loop_delay = 0.0;            ///< samples from a reading to the effect of its currents
  bool preview = true;                ///< false: accelerations of the same tick, as if the loop had no delay
  double along_rad_s = 70.0;          ///< bandwidth of all joints, or along the path
  double across_rad_s = 240.0;        ///< contouring: across the path
  double observer_rad_s = 400.0;      ///< of the disturbance
  double velocity_rad_s = 900.0;      ///< of the velocity estimate
  ModelUse model = ModelUse::kWhole;  ///< preview, contouring
  ModelUse independent_model = ModelUse::kNone;  ///< as in the thesis (eq. 21, 32)
};

}  // namespace telekerf::machining
