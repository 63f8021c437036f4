// SPDX-License-Identifier: Apache-2.0
// Power that follows the tool's speed: each millimetre gets the same energy, and a tool that rests gets none.
#pragma once

#include <algorithm>

#include "common/runtime/vectors.h"

namespace telekerf::laser {

struct BeamPowerSettings {
  double speed_m_per_s = 10e-3;         ///< with the whole power; by default a hand's 20 mm/s, scaled by half
  double floor_m_per_s = 0.3e-3;        ///< a slower tool gets nothing
  static constexpr double kMost = 1.5;  ///< times the power, however fast the tool is
};

/// Fraction of the power. A speed that is no magnitude gets nothing.
inline double power_fraction(const BeamPowerSettings& settings, double speed_m_per_s) noexcept {
  if (!(speed_m_per_s >= settings.floor_m_per_s)) return 0.0;
  return std::min(speed_m_per_s / settings.speed_m_per_s, BeamPowerSettings::kMost);
}

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
