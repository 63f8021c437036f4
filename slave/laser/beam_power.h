// SPDX-License-Identifier: Apache-2.0
// Power that follows the tool's speed: each millimetre gets the same energy, and a tool that rests gets none.
#pragma once

#include "common/runtime/vectors.h"
#include "common/workpiece/beam.h"

namespace telekerf::laser {

using workpiece::BeamPowerSettings;
using workpiece::power_fraction;

/// The tool's speed in the workpiece's plane as the power follows it: the observer's velocity, low-passed as
/// a vector so that its noise does not add up to a speed.
class CutSpeed {
 public:
  explicit CutSpeed(double dt_s) noexcept : share_(dt_s / (kLag_s + dt_s)) {}
  /// Every control step, m/s. What is not finite starts it over from rest.
  double step(const Vec3& velocity_m_per_s) noexcept {
    smooth_ += share_ * (velocity_m_per_s.head<2>() - smooth_);
    if (!smooth_.allFinite()) smooth_.setZero();
    return smooth_.norm();
  }

 private:
  static constexpr double kLag_s = 4e-3;
  double share_;
  Vec2 smooth_ = Vec2::Zero();
};

}  // namespace telekerf::laser
