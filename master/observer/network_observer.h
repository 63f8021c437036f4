// SPDX-License-Identifier: Apache-2.0
// The network observer (thesis 5.3.2; docs/results/delay.md): where will the slave be when the command that
// is made now acts on it? One interface over every estimator; no clock and no delay is ever estimated for it,
// because the slave's echo says which commands it has applied ("delay-free by sequence acknowledgement").
#pragma once

#include <span>

#include "master/observer/command_history.h"
#include "master/observer/estimators.h"

namespace telekerf::master {

struct ObserverSettings : EstimatorSettings {
  MakeEstimator estimator = &make_predictor;
};

class NetworkObserver {
 public:
  NetworkObserver(Law law, const ObserverSettings& settings);

  /// The slave rests in `state`, and the command of `index` is the next that it will apply.
  void reset(std::int64_t index, const KinematicState& state) noexcept;
  /// `command` acts at `index` on the model's state; m/s^2, after clipping. Indices follow each other.
  void predict(std::int64_t index, const KinematicState& model, const Vec3& command) noexcept;
  /// The codec made `decoded` of the commands from `first` on, the last ones sent; `anchor` is the block's
  /// (as the wire holds it) and the result the model after the block: what the slave's integration will
  /// reach, bit for bit.
  KinematicState revise(std::int64_t first, const KinematicState& anchor,
                        std::span<const Vec3> decoded) noexcept;
  /// What the slave measured, in the order of its clock.
  void correct(std::span<const SlaveSample> samples) noexcept;

  /// Position and velocity at which the next command will act. `model`: the commands' own integral there.
  KinematicState predicted_state(const KinematicState& model) noexcept;
  /// What the predictor believes to act on the slave beside its commands, m/s^2.
  Vec3 disturbance_m_per_s2() const noexcept;
  /// Newest measurement minus what had been predicted for it, m.
  Vec3 innovation_m() const noexcept;
  /// From making a command to knowing what it did, s.
  double delay_s() const noexcept { return delay_s_; }
  /// What the model must take over at a block's beginning, m.
  Vec3 take_correction_m() noexcept;

 private:
  void revise_estimator(const KinematicState& change) noexcept;

  double period_s_;
  CommandHistory history_;
  AnyEstimator estimator_;
  std::int64_t next_ = 0;
  double delay_s_ = 0.0;
};

}  // namespace telekerf::master
