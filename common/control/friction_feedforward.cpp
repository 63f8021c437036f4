// SPDX-License-Identifier: Apache-2.0
#include "common/control/friction_feedforward.h"

#include <algorithm>
#include <cmath>

#include "common/robot/dynamics.h"

namespace telekerf::control {

FrictionFeedforward::FrictionFeedforward(const robot::Friction& nominal,
                                         const DisturbanceObserver::Gains& gains) noexcept
    : ahead_(nominal),
      nominal_(nominal),
      late_(static_cast<std::size_t>(
          std::lround(std::clamp(gains.loop_delay, 0.0, static_cast<double>(kMaxLoopDelay))))) {
  friction_n_.fill(Vec3::Zero());
  given_n_.fill(Vec3::Zero());
  // Given ahead through a softer step than the model's: a friction that is cancelled too steeply is a
  // negative damping at rest.
  constexpr double kSoftest = 2e-3;
  ahead_.smoothing_velocity_m_per_s = std::max(nominal.smoothing_velocity_m_per_s, kSoftest);
  rate_[0] = 1.0 - std::exp(-gains.bandwidth_rad_per_s * gains.period_s);
  rate_[1] = rate_[2] = 1.0 - std::exp(-gains.velocity_bandwidth_rad_per_s * gains.period_s);
  for (auto* stages : {&stages_, &given_stages_}) {
    for (auto& stage : *stages) stage.setZero();
  }
}

void FrictionFeedforward::update(const Vec3& joint_velocity_m_per_s) noexcept {
  // What the observer sees now acted over the last period.
  const auto pass = [&](Vec3(&stages)[3], const Vec3& in) {
    const Vec3* source = &in;
    for (int i = 0; i < 3; ++i) {
      stages[i] += rate_[i] * (*source - stages[i]);
      source = &stages[i];
    }
  };
  pass(stages_, friction_n_[late_]);
  pass(given_stages_, given_n_[late_]);
  for (auto* past : {&friction_n_, &given_n_})
    std::copy_backward(past->begin(), past->end() - 1, past->end());
  friction_n_[0] = robot::friction_force(nominal_, joint_velocity_m_per_s);
  given_n_[0] = robot::friction_force(ahead_, joint_velocity_m_per_s);
  missing_n_ = given_n_[0] - given_stages_[2];
}

}  // namespace telekerf::control
