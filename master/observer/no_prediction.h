// SPDX-License-Identifier: Apache-2.0
// Estimator `none`: the newest measurement is taken for the present. Stable with the tracking law only while
// w D < 0.6475 (critically damped; docs/results/delay.md).
#pragma once

#include "master/observer/estimator.h"

namespace telekerf::master {

class NoPrediction {
 public:
  explicit NoPrediction(const EstimatorSettings& /*settings*/) noexcept {}

  void reset(std::int64_t /*index*/, const KinematicState& state) noexcept { state_ = state; }
  void predict(const CommandHistory& /*history*/, std::int64_t /*index*/) noexcept {}
  void correct(const CommandHistory& /*history*/, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    state_ = {.position_m = sample.position_m, .velocity_m_per_s = sample.velocity_m_per_s};
  }
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }

 private:
  KinematicState state_;
};

}  // namespace telekerf::master
