// SPDX-License-Identifier: Apache-2.0
// A joint that has arrived is left alone: its motor keeps the force that it has. A loop that goes on working
// on the last part of an encoder's step winds that force up and down against the friction for ever, and where
// the sensor sticks meanwhile it pushes the joint away unseen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/control/kinematic_state.h"
#include "common/robot/robot.h"
#include "common/robot/sensor_noise.h"

namespace telekerf::control {

/// Of one robot. No allocation, lock or throw.
class Standstill {
 public:
  Standstill(const robot::Sensor& sensor, double period_s) noexcept
      : near_m_(kNear * robot::reading_noise_m(sensor)),
        steps_(static_cast<int>(std::ceil(kAfter_s / period_s))) {}

  /// Every step: what is asked of the joints, m/s^2, without that of those that stand where they are to be. A
  /// joint does where the reference rests, and its reading has been the same for a while.
  Vec3 step(const KinematicState& reference, const Vec3& joint_error_m, const robot::JointReading& reading,
            Vec3 asked_m_per_s2) noexcept {
    const bool rests = reference.velocity_m_per_s.norm() < kRest_m_per_s &&
                       reference.acceleration_m_per_s2.norm() * kAfter_s < kRest_m_per_s;
    for (int i = 0; i < 3; ++i) {
      int& same = same_[static_cast<std::size_t>(i)];
      const bool stands = rests && (!reading.valid || reading.joints_m[i] == read_m_[i]);
      same = stands ? std::min(same + 1, steps_) : 0;
      if (same == steps_ && std::abs(joint_error_m[i]) < near_m_) asked_m_per_s2[i] = 0.0;
    }
    if (reading.valid) read_m_ = reading.joints_m;
    return asked_m_per_s2;
  }

 private:
  static constexpr double kNear = 5.0;  ///< rms of a reading: a step and a half of an encoder
  static constexpr double kAfter_s = 0.01;
  static constexpr double kRest_m_per_s = 1e-5;
  double near_m_;
  int steps_;
  std::array<int, 3> same_{};
  Vec3 read_m_ = Vec3::Zero();
};

}  // namespace telekerf::control
