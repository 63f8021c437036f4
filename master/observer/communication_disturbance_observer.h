// SPDX-License-Identifier: Apache-2.0
// Estimator `thesis` (eq. 93-95 with a low-pass of g): the command's integral below g, the delayed
// measurement above it: v = s/(s+g) v(t-D) + g/(s+g) (1/s) u. It needs no delay model. An initial velocity
// error never decays and a constant disturbance drifts without bound: the thesis leaves both to a convergence
// term that it does not give.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "master/observer/estimator.h"

namespace telekerf::master {

class CommunicationDisturbanceObserver {
 public:
  explicit CommunicationDisturbanceObserver(const EstimatorSettings& settings) noexcept
      : period_s_(settings.period_s), keep_(std::exp(-settings.thesis_cutoff_rad_s * settings.period_s)) {}

  void reset(std::int64_t /*index*/, const KinematicState& state) noexcept {
    state_ = state;
    integral_ = low_command_ = low_measured_ = measured_ = state.velocity_m_per_s;
    waiting_ = 0;
  }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    // A block's measurements are taken one a tick, as they were made.
    if (waiting_ > 0) measured_ = queue_[(next_ + kQueue - static_cast<std::size_t>(waiting_--)) % kQueue];
    integral_ += period_s_ * history.acceleration(index);
    low_command_ = keep_ * low_command_ + (1.0 - keep_) * integral_;
    low_measured_ = keep_ * low_measured_ + (1.0 - keep_) * measured_;
    const Vec3 velocity = measured_ - low_measured_ + low_command_;
    state_.position_m += 0.5 * period_s_ * (state_.velocity_m_per_s + velocity);
    state_.velocity_m_per_s = velocity;
  }
  void revise(const CommandHistory& /*history*/, std::int64_t /*next*/,
              const KinematicState& change) noexcept {
    integral_ += change.velocity_m_per_s;
    state_.position_m += change.position_m;
  }
  void correct(const CommandHistory& history, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    queue_[next_] = sample.velocity_m_per_s;
    next_ = (next_ + 1) % kQueue;
    waiting_ = std::min(waiting_ + 1, static_cast<int>(kQueue));
    if (const SentCommand* then = history.find(sample.index))
      innovation_ = sample.position_m - then->model.position_m;
  }
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }
  Vec3 innovation_m() const noexcept { return innovation_; }

 private:
  static constexpr std::size_t kQueue = 64;
  double period_s_;
  double keep_;
  KinematicState state_;
  Vec3 integral_ = Vec3::Zero();      ///< of the command, m/s
  Vec3 low_command_ = Vec3::Zero();   ///< g/(s+g) of it
  Vec3 low_measured_ = Vec3::Zero();  ///< g/(s+g) of the delayed velocity
  Vec3 measured_ = Vec3::Zero();
  Vec3 innovation_ = Vec3::Zero();
  std::array<Vec3, kQueue> queue_{};
  std::size_t next_ = 0;
  int waiting_ = 0;
};

}  // namespace telekerf::master
