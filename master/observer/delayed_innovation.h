// SPDX-License-Identifier: Apache-2.0
// A model that old measurements correct, x' = A x + B u + l (y - x(t-D)): the natural reading of the thesis'
// "convergence term", which it names and leaves to its reference [115]. Stable iff 0 < l D < pi/2, fastest
// without oscillation at l = 1/(e D); a constant disturbance leaves a bias.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>

#include "master/observer/estimator.h"

namespace telekerf::master {

/// `Model`: an estimator whose idea of the slave can be shifted (revise). OpenIntegrator makes the estimator
/// `delayed-innovation`, the thesis' observer `thesis-convergent`.
template <class Model>
class DelayedInnovation {
 public:
  /// Without a gain of the user's: 1/(e D) of the delay that the acknowledgements show.
  explicit DelayedInnovation(const EstimatorSettings& settings)
      : gain_per_s_(settings.innovation_gain_per_s),
        period_s_(settings.period_s),
        model_(settings),
        past_(std::make_unique<Past>()) {}

  void reset(std::int64_t index, const KinematicState& state) noexcept {
    model_.reset(index, state);
    begun_ = index;
  }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    (*past_)[static_cast<std::size_t>(index) % CommandHistory::kSize] =
        model_.predicted_state(history, index);
    model_.predict(history, index);
  }
  void revise(const CommandHistory& history, std::int64_t next, const KinematicState& change) noexcept {
    model_.revise(history, next, change);
  }
  void correct(const CommandHistory& history, const SlaveSample& sample, std::int64_t next) noexcept {
    if (sample.index < begun_) return;
    model_.correct(history, sample, next);
    if (!sample.applied || history.find(sample.index) == nullptr) return;
    const KinematicState& then = (*past_)[static_cast<std::size_t>(sample.index) % CommandHistory::kSize];
    innovation_ = sample.position_m - then.position_m;
    const double delay_s = static_cast<double>(next - sample.index) * period_s_;
    const double gain =
        gain_per_s_ > 0.0 ? gain_per_s_ : 1.0 / (std::numbers::e * std::max(delay_s, kShortest_s));
    model_.revise(history, next,
                  {.position_m = gain * period_s_ * innovation_,
                   .velocity_m_per_s = gain * period_s_ * (sample.velocity_m_per_s - then.velocity_m_per_s)});
  }
  KinematicState predicted_state(const CommandHistory& history, std::int64_t next) const noexcept {
    return model_.predicted_state(history, next);
  }
  Vec3 innovation_m() const noexcept { return innovation_; }

 private:
  using Past = std::array<KinematicState, CommandHistory::kSize>;
  static constexpr double kShortest_s = 0.02;
  double gain_per_s_;
  double period_s_;
  Model model_;
  Vec3 innovation_ = Vec3::Zero();
  std::int64_t begun_ = 0;
  std::unique_ptr<Past> past_;  ///< what was thought at each index
};

}  // namespace telekerf::master
