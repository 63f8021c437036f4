// SPDX-License-Identifier: Apache-2.0
// The network observer (thesis 5.3.2; docs/reference/streaming.md): where will the slave be when the command
// that is made now acts on it? One interface over every estimator; no clock and no delay is ever estimated
// for it, because the slave's echo says which commands it has applied ("delay-free by sequence
// acknowledgement").
#pragma once

#include <span>
#include <string>
#include <variant>

#include "master/observer/command_history.h"
#include "master/observer/communication_disturbance_observer.h"
#include "master/observer/delayed_innovation.h"
#include "master/observer/no_prediction.h"
#include "master/observer/propagated_predictor.h"
#include "master/observer/reference_model_estimator.h"

namespace telekerf::master {

enum class Estimator : std::uint8_t { kNone, kThesis, kDelayedInnovation, kPredictor };

/// The words of command lines and reports.
const char* to_string(Estimator estimator) noexcept;
const char* to_string(Law law) noexcept;
/// Throw StartupError.
Estimator estimator_named(const std::string& name);
Law law_named(const std::string& name);

struct ObserverSettings {
  Estimator estimator = Estimator::kPredictor;
  double period_s = 1e-3;              ///< of the command stream
  double thesis_cutoff_rad_s = 100.0;  ///< g of eq. 93's low-pass
  double innovation_gain_per_s = 0.0;  ///< l of delayed-innovation; 0: 1/(e D)
  double predictor_rad_s = 20.0;       ///< poles of the predictor's observer: position and velocity
  double disturbance_rad_s = 1.0;      ///< its pole of the disturbance
  double followed_gain = 0.002;        ///< a sample; of a slave that follows anchors
};

class NetworkObserver {
 public:
  NetworkObserver(Law law, const ObserverSettings& settings);

  /// The slave rests in `state`, and the command of `index` is the next that it will apply.
  void begin(std::int64_t index, const KinematicState& state) noexcept;
  /// `command` acts at `index` on the model's state; m/s^2, after clipping. Indices follow each other.
  void sent(std::int64_t index, const KinematicState& model, const Vec3& command) noexcept;
  /// The codec made `decoded` of the commands from `first` on, the last ones sent; `anchor` is the block's
  /// (as the wire holds it) and the result the model after the block: what the slave's integration will
  /// reach, bit for bit.
  KinematicState coded(std::int64_t first, const KinematicState& anchor,
                       std::span<const Vec3> decoded) noexcept;
  /// What the slave measured, in the order of its clock.
  void measured(std::span<const SlaveSample> samples) noexcept;

  /// Position and velocity at which the next command will act. `model`: the commands' own integral there.
  KinematicState prediction(const KinematicState& model) noexcept;
  /// What the predictor believes to act on the slave beside its commands, m/s^2.
  Vec3 disturbance_m_per_s2() const noexcept;
  /// Newest measurement minus what had been predicted for it, m.
  Vec3 innovation_m() const noexcept;
  /// From making a command to knowing what it did, s.
  double delay_s() const noexcept { return delay_s_; }
  /// What the model must take over at a block's beginning, m.
  Vec3 take_correction() noexcept;

 private:
  using AnyEstimator = std::variant<NoPrediction, CommunicationDisturbanceObserver, DelayedInnovation,
                                    PropagatedPredictor, ReferenceModelEstimator>;
  static AnyEstimator make(Law law, const ObserverSettings& settings);

  double period_s_;
  CommandHistory ring_;
  AnyEstimator estimator_;
  std::int64_t next_ = 0;
  double delay_s_ = 0.0;
};

}  // namespace telekerf::master
