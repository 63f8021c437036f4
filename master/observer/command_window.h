// SPDX-License-Identifier: Apache-2.0
// Estimator `thesis-window`: eq. 94's integral over the commands that the measurement does not show yet, and
// over them only, v = v(t-D) + integral of u from t-D to t; the position likewise, x = x(t-D) + integral of
// v. Nothing is left of a wrong start after one delay; an unknown force is seen one delay late.
#pragma once

#include <algorithm>
#include <array>
#include <memory>

#include "master/observer/estimator.h"

namespace telekerf::master {

class CommandWindow {
 public:
  explicit CommandWindow(const EstimatorSettings& settings)
      : period_s_(settings.period_s), velocities_(std::make_unique<Velocities>()) {}

  void reset(std::int64_t index, const KinematicState& state) noexcept {
    state_ = measured_ = state;
    begun_ = measured_at_ = index;
  }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    // Where the mean of this sample and the next is needed, the command's half step makes it.
    velocity(index) = state_.velocity_m_per_s + 0.5 * period_s_ * history.acceleration(index);
    state_.acceleration_m_per_s2 = history.acceleration(index);
    state_ = advanced(state_, period_s_);
  }
  /// Once for a batch of measurements, and when the codec has changed the last commands.
  void revise(const CommandHistory& history, std::int64_t next, const KinematicState& /*change*/) noexcept {
    const auto from = std::max(measured_at_, next - static_cast<std::int64_t>(CommandHistory::kSize));
    state_ = measured_;
    for (std::int64_t index = from; index < next; ++index) {
      state_.velocity_m_per_s += period_s_ * history.acceleration(index);
      state_.position_m += period_s_ * velocity(index);
    }
  }
  void correct(const CommandHistory& history, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    if (sample.index < begun_) return;
    if (const SentCommand* then = history.find(sample.index))
      innovation_ = sample.position_m - then->model.position_m;
    measured_ = {.position_m = sample.position_m, .velocity_m_per_s = sample.velocity_m_per_s};
    measured_at_ = sample.index;
  }
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return state_;
  }
  Vec3 innovation_m() const noexcept { return innovation_; }

 private:
  using Velocities = std::array<Vec3, CommandHistory::kSize>;
  Vec3& velocity(std::int64_t index) noexcept {
    return (*velocities_)[static_cast<std::size_t>(index) % CommandHistory::kSize];
  }

  double period_s_;
  KinematicState state_;     ///< where the next command will act
  KinematicState measured_;  ///< as measured when command measured_at_ was to act
  std::int64_t measured_at_ = 0;
  std::int64_t begun_ = 0;
  Vec3 innovation_ = Vec3::Zero();
  std::unique_ptr<Velocities> velocities_;  ///< mean ones over each sample, as estimated when it was made
};

}  // namespace telekerf::master
