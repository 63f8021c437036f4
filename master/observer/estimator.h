// SPDX-License-Identifier: Apache-2.0
// What an estimator of the slave's state is: reset, predict, correct, predicted_state. The network observer
// drives any type that has these, and uses what it has beside them.
#pragma once

#include <concepts>
#include <cstdint>

#include "master/observer/command_history.h"

namespace telekerf::master {

/// What a user can choose of estimators; each takes what concerns it.
struct EstimatorSettings {
  double period_s = 1e-3;              ///< of the command stream
  double thesis_cutoff_rad_s = 100.0;  ///< g of eq. 93's low-pass
  double innovation_gain_per_s = 0.0;  ///< l of delayed-innovation; 0: 1/(e D)
  double predictor_rad_s = 20.0;       ///< poles of the predictor's observer: position and velocity
  double disturbance_rad_s = 1.0;      ///< its pole of the disturbance
  double followed_gain = 0.002;        ///< a sample; of a slave that follows anchors
};

/// Indices count samples of the command stream; `next` is the one whose command is made now. All of it is
/// called in the control loop: no allocation, lock or throw after construction.
template <class E>
concept Estimator = std::constructible_from<E, const EstimatorSettings&> &&
    requires(E estimator, const E known, const CommandHistory& history, const KinematicState& state,
             const SlaveSample& sample, std::int64_t index) {
  /// The slave rests in `state`, and the command of `index` is the next that it will apply.
  { estimator.reset(index, state) }
  noexcept;
  /// A sample on: the command of `index`, which is in the history, acts on the slave.
  { estimator.predict(history, index) }
  noexcept;
  /// What the slave measured some time ago, in the order of its clock. `index`: next.
  { estimator.correct(history, sample, index) }
  noexcept;
  /// Position and velocity at which the next command will act. `index`: next.
  { known.predicted_state(history, index) }
  noexcept->std::same_as<KinematicState>;
};

// An estimator may have more.

/// The last block's commands in the history were replaced by what every receiver decodes of them, which
/// changes their integral by `change`; also called with no change after the last of a batch of corrections.
template <class E>
concept RevisesCommands = requires(E estimator, const CommandHistory& history, const KinematicState& change,
                                   std::int64_t next) {
  { estimator.revise(history, next, change) }
  noexcept;
};
/// What it believes to act on the slave beside its commands, m/s^2.
template <class E>
concept EstimatesDisturbance = requires(const E known) {
  { known.disturbance_m_per_s2() }
  noexcept->std::convertible_to<Vec3>;
};
/// Newest measurement minus what had been predicted for it, m.
template <class E>
concept HasInnovation = requires(const E known) {
  { known.innovation_m() }
  noexcept->std::convertible_to<Vec3>;
};
/// What the commands' own model must take over where a block begins, m; asked for once.
template <class E>
concept CorrectsModel = requires(E estimator) {
  { estimator.take_correction_m() }
  noexcept->std::convertible_to<Vec3>;
};

}  // namespace telekerf::master
