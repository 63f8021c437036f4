// SPDX-License-Identifier: Apache-2.0
// The slave as its commands alone would move it: a double integrator of each axis, measured by nobody.
#pragma once

#include "master/observer/estimator.h"

namespace telekerf::master {

class OpenIntegrator {
 public:
  explicit OpenIntegrator(const EstimatorSettings& settings) noexcept : period_s_(settings.period_s) {}

  void reset(std::int64_t /*index*/, const KinematicState& state) noexcept { state_ = state; }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    state_.acceleration_m_per_s2 = history.acceleration(index);
    state_ = advanced(state_, period_s_);
  }
  void revise(const CommandHistory& /*history*/, std::int64_t /*next*/,
              const KinematicState& change) noexcept {
    state_.position_m += change.position_m;
    state_.velocity_m_per_s += change.velocity_m_per_s;
  }
  void correct(const CommandHistory& /*history*/, const SlaveSample& /*sample*/,
               std::int64_t /*next*/) noexcept {}
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }

 private:
  double period_s_;
  KinematicState state_;
};

}  // namespace telekerf::master
