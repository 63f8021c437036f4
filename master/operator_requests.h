// SPDX-License-Identifier: Apache-2.0
// What operators ask the master for by event: whether the slave shall follow, and at which scale.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "common/protocol/messages.h"

namespace telekerf::master {

inline constexpr double kSmallestBeta = 0.01;
inline constexpr double kLargestBeta = 10.0;

/// Events are heard in the control loop; contours are scaled in another thread, one at a time.
class OperatorRequests {
 public:
  OperatorRequests(bool engage, double beta) noexcept
      : engage_(engage), wanted_beta_(beta), beta_in_force_(beta) {}

  /// What holds when an event comes.
  struct Situation {
    bool stopped = false;
    bool beam_on = false;
    bool stream_changes = false;  ///< another law, estimator or codec is being made ready
  };
  struct Heard {
    bool rescale = false;           ///< another scale is asked for: the contour must be prepared for it
    const char* refusal = nullptr;  ///< a literal: why nothing comes of an event
  };
  static bool concerns(const EventMessage& event) noexcept {
    using Kind = EventMessage::Kind;
    return event.kind == Kind::kEngage || event.kind == Kind::kDisengage || event.kind == Kind::kSetBeta;
  }
  /// A scale out of bounds is no request. Wait-free.
  Heard hear(std::span<const EventMessage> events, const Situation& now) noexcept;
  /// Of a control step.
  struct Waiting {
    bool led = false;         ///< the slave is, so nothing is waited for
    bool guiding = false;     ///< it is the slave alone that is waited for
    bool slave_gone = false;  ///< it was heard, and is not any more
    double most_s = 0.0;      ///< that may pass without a step: the beam's gate
  };
  /// Every control step, once. What an event has asked for is not kept until the slave can be led at last,
  /// when perhaps nobody reckons with it any more: it is over when the slave is gone for 0.5 s, when this
  /// process has slept, and after 5 s. Why, a literal; null: it is not over. The engagement that the settings
  /// ask for waits. Wait-free.
  const char* wait(std::int64_t now_ns, const Waiting& now) noexcept;
  /// The wish to engage is over, until the next event.
  void spend_engage() noexcept { engage_ = false; }
  /// The slave shall follow, as soon as everything is ready for it.
  bool engage() const noexcept { return engage_; }

  /// The scale that a contour is to be prepared for.
  double wanted_beta() const noexcept { return wanted_beta_.load(); }
  /// What became of a contour at the scale `beta`. Refused: the last scale that was granted is wanted again,
  /// unless another one has been asked for meanwhile.
  void granted(double beta) noexcept { beta_in_force_ = beta; }
  void refused(double beta) noexcept { wanted_beta_.compare_exchange_strong(beta, beta_in_force_); }

 private:
  bool engage_;
  bool by_event_ = false;
  double waited_s_ = 0.0, gone_s_ = 0.0;
  std::int64_t stepped_ns_ = 0;  ///< the step before; 0: none
  std::atomic<double> wanted_beta_;
  double beta_in_force_;  ///< the preparing thread's
};

}  // namespace telekerf::master
