// SPDX-License-Identifier: Apache-2.0
// Estimator `predictor` for a slave that obeys bare accelerations: observe in the slave's own sample time,
// then replay the commands that are still on their way,
//   z_{i+1} = Phi z_i + Gamma (u_i + d) + L (y - z),  x = Phi^n z + sum of what is not acknowledged yet.
// One step of it is x_{k+1} = Phi x + Gamma u + Phi^n L (y - z): the innovation is propagated through the
// delay, which is this project's convergence term. The error of (z, d) decays at the chosen rate for every
// delay, initial state and constant disturbance.
#pragma once

#include <algorithm>

#include "common/control/observer_gains.h"
#include "master/observer/estimator.h"

namespace telekerf::master {

class PropagatedPredictor {
 public:
  /// Poles z = exp(-p h), two at `predictor_rad_s` and one at `disturbance_rad_s`, as observer_gains() places
  /// them. An error e_d of the disturbance is worth D^2/2 e_d of prediction, so that pole is slow; a kick
  /// (friction at a reversal) is forgotten at the other rate.
  explicit PropagatedPredictor(const EstimatorSettings& settings) noexcept : period_s_(settings.period_s) {
    const control::ObserverGains gains =
        control::observer_gains(settings.disturbance_rad_s, settings.predictor_rad_s, settings.period_s);
    alpha_ = gains.alpha;
    beta_ = gains.beta / period_s_;
    gamma_ = gains.gamma / (period_s_ * period_s_);
  }

  void reset(std::int64_t index, const KinematicState& state) noexcept {
    observed_ = predicted_ = state;
    begun_ = at_ = index;
    started_ = false;
  }
  void predict(const CommandHistory& history, std::int64_t index) noexcept {
    predicted_.acceleration_m_per_s2 = history.acceleration(index) + disturbance_;
    predicted_ = advanced(predicted_, period_s_);
  }
  void revise(const CommandHistory& history, std::int64_t next, const KinematicState& /*change*/) noexcept {
    replay(history, next);
  }
  /// In the order of the slave's clock; call revise() after the last of a batch.
  void correct(const CommandHistory& history, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    if (sample.index < begun_) return;
    unapplied_ = sample.applied ? 0 : unapplied_ + 1;
    const std::int64_t commands = sample.index - at_;
    const std::int64_t steps = sample.time - time_;
    const double gap_s = static_cast<double>(std::max<std::int64_t>(steps, unapplied_)) * period_s_;
    if (!started_ || commands < 0 || steps <= 0 || gap_s > kTrusted_s) {
      // Nothing is known of what moves the slave then: take it as it is.
      observed_ = {.position_m = sample.position_m, .velocity_m_per_s = sample.velocity_m_per_s};
      started_ = sample.applied;
    } else {
      // The slave bridges short gaps by what lies on both sides of them, about what was sent.
      // As many commands as steps, but for a play-out that waited or skipped.
      for (std::int64_t i = 0; i < steps; ++i) {
        observed_.acceleration_m_per_s2 = history.acceleration(at_ + i * commands / steps) + disturbance_;
        observed_ = advanced(observed_, period_s_);
      }
      innovation_ = sample.position_m - observed_.position_m;
      observed_.position_m += alpha_ * innovation_;
      observed_.velocity_m_per_s += beta_ * innovation_;
      if (sample.applied) disturbance_ += gamma_ * innovation_;
      const double size = disturbance_.norm();
      if (size > kLargest_m_per_s2) disturbance_ *= kLargest_m_per_s2 / size;
    }
    at_ = sample.index;
    time_ = sample.time;
  }
  KinematicState predicted_state(const CommandHistory& /*history*/, std::int64_t /*next*/) const noexcept {
    return predicted_;
  }
  Vec3 disturbance_m_per_s2() const noexcept { return disturbance_; }
  Vec3 innovation_m() const noexcept { return innovation_; }

 private:
  void replay(const CommandHistory& history, std::int64_t next) noexcept {
    predicted_ = observed_;
    const auto from = std::max(at_, next - static_cast<std::int64_t>(CommandHistory::kSize));
    for (std::int64_t i = from; i < next; ++i) {
      predicted_.acceleration_m_per_s2 = history.acceleration(i) + disturbance_;
      predicted_ = advanced(predicted_, period_s_);
    }
  }
  static constexpr double kLargest_m_per_s2 = 2.0;  ///< of what a disturbance observer leaves
  static constexpr double kTrusted_s =
      0.15;  ///< longest gap, in commands or in measurements, that the model is trusted over
  double period_s_;
  double alpha_ = 0.0;
  double beta_ = 0.0;
  double gamma_ = 0.0;
  KinematicState observed_;   ///< z, at index at_ of the slave's time
  KinematicState predicted_;  ///< x, where the next command will act
  Vec3 disturbance_ = Vec3::Zero();
  Vec3 innovation_ = Vec3::Zero();
  std::int64_t begun_ = 0;
  std::int64_t at_ = 0;
  std::int64_t time_ = 0;
  bool started_ = false;
  int unapplied_ = 0;  ///< samples in a row
};

}  // namespace telekerf::master
