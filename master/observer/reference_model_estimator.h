// SPDX-License-Identifier: Apache-2.0
// Estimator `predictor` for a slave that follows the anchors: it makes the master's model true by itself, so
// the prediction is the model, and the innovation is fed back very gently, only to learn of what lasts.
#pragma once

#include <algorithm>

#include "master/observer/command_history.h"

namespace telekerf::master {

class ReferenceModelEstimator {
 public:
  explicit ReferenceModelEstimator(double gain) noexcept : gain_(gain) {}

  void begin(std::int64_t index, const KinematicState& /*state*/) noexcept {
    begun_ = index;
    correction_.setZero();
  }
  void sent(const CommandHistory& /*ring*/, std::int64_t /*index*/) noexcept {}
  void replaced(const CommandHistory& /*ring*/, std::int64_t /*next*/,
                const KinematicState& /*change*/) noexcept {}
  void measured(const CommandHistory& ring, const SlaveSample& sample, std::int64_t /*next*/) noexcept {
    const SentCommand* then = ring.find(sample.index);
    if (!sample.applied || sample.index < begun_ || then == nullptr) return;
    innovation_ = sample.position_m - then->model.position_m;
    // More than the slave's own loop can leave is a fault or an approach, and nothing to learn from.
    const double size_m = innovation_.norm();
    correction_ += gain_ * (size_m > kLargestM ? kLargestM / size_m : 1.0) * innovation_;
  }
  KinematicState prediction(const CommandHistory& ring, std::int64_t next) const noexcept {
    const SentCommand* now = ring.find(next);
    return now == nullptr ? KinematicState{} : now->model;
  }
  Vec3 disturbance() const noexcept { return Vec3::Zero(); }
  Vec3 innovation() const noexcept { return innovation_; }
  /// To be added to the model where a block begins, so that its anchor carries it.
  Vec3 take_correction() noexcept {
    Vec3 taken = correction_;
    correction_.setZero();
    return taken;
  }

 private:
  static constexpr double kLargestM = 0.1e-3;
  double gain_;
  std::int64_t begun_ = 0;
  Vec3 innovation_ = Vec3::Zero();
  Vec3 correction_ = Vec3::Zero();
};

}  // namespace telekerf::master
