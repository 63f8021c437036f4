// SPDX-License-Identifier: Apache-2.0
// Estimator `predictor` for a slave that follows the anchors: it makes the master's model true by itself, so
// the prediction is the model, and the innovation is fed back very gently, only to learn of what lasts.
#pragma once

#include <algorithm>

#include "master/observer/estimator.h"

namespace telekerf::master {

class ReferenceModelEstimator {
 public:
  explicit ReferenceModelEstimator(const EstimatorSettings& settings) noexcept
      : gain_(settings.followed_gain) {}

  void reset(std::int64_t index, const KinematicState& /*state*/) noexcept {
    begun_ = index;
    correction_.setZero();
  }
  void predict(const CommandHistory& /*history*/, std::int64_t /*index*/) noexcept {}
  void correct(const CommandHistory& history, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    const SentCommand* then = history.find(sample.index);
    if (!sample.applied || sample.index < begun_ || then == nullptr) return;
    innovation_ = sample.position_m - then->model.position_m;
    // More than the slave's own loop can leave is a fault or an approach, and nothing to learn from.
    const double size_m = innovation_.norm();
    correction_ += gain_ * (size_m > kLargest_m ? kLargest_m / size_m : 1.0) * innovation_;
  }
  KinematicState predicted_state(const CommandHistory& history, std::int64_t next) const noexcept {
    const SentCommand* now = history.find(next);
    return now == nullptr ? KinematicState{} : now->model;
  }
  Vec3 innovation_m() const noexcept { return innovation_; }
  /// To be added to the model where a block begins, so that its anchor carries it.
  Vec3 take_correction_m() noexcept {
    Vec3 taken = correction_;
    correction_.setZero();
    return taken;
  }

 private:
  static constexpr double kLargest_m = 0.1e-3;
  double gain_;
  std::int64_t begun_ = 0;
  Vec3 innovation_ = Vec3::Zero();
  Vec3 correction_ = Vec3::Zero();
};

}  // namespace telekerf::master
