// SPDX-License-Identifier: Apache-2.0
// Estimator `none`: the newest measurement is taken for the present. Stable with the tracking law only while
// w D < 0.6475 (critically damped; observer.md, "Limits").
#pragma once

#include "master/observer/command_history.h"

namespace telekerf::master {

class NoPrediction {
 public:
  void begin(std::int64_t /*index*/, const KinematicState& state) noexcept { state_ = state; }
  void sent(const CommandHistory& /*ring*/, std::int64_t /*index*/) noexcept {}
  void replaced(const CommandHistory& /*ring*/, std::int64_t /*next*/,
                const KinematicState& /*change*/) noexcept {}
  void measured(const CommandHistory& /*ring*/, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    state_ = {.position_m = sample.position_m, .velocity_m_per_s = sample.velocity_m_per_s};
  }
  KinematicState prediction(const CommandHistory& /*ring*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }
  Vec3 disturbance() const noexcept { return Vec3::Zero(); }
  Vec3 innovation() const noexcept { return Vec3::Zero(); }
  Vec3 take_correction() noexcept { return Vec3::Zero(); }

 private:
  KinematicState state_;
};

}  // namespace telekerf::master
