// SPDX-License-Identifier: Apache-2.0
// What the operator does, and what it looks like to the stations: engage, button, stop, clear, scale. All of
// it is here.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/protocol/messages.h"
#include "experiments/draw.h"
#include "master/modes.h"

namespace telekerf::experiments {

EventMessage engage_event();
EventMessage scale_event(double beta);

/// What the operator says at one step.
struct Said {
  std::vector<EventMessage> events;
  bool clear = false;  ///< the emergency stop is over
};

/// What the operator's console shows, at one step of the master.
struct OperatorView {
  std::int64_t now_ns = 0;  ///< true time
  master::MasterMode mode = master::MasterMode::kIdle;
  const StateHeader* slave = nullptr;  ///< newest that came; null: none
  std::int64_t slave_heard_ns = 0;     ///< true time
};

/// Engages when everything is ready, holds the button, and after a trouble waits a while, clears a stop,
/// lets the button go (not always) and engages anew. From `heal_s` on it engages once more and no second
/// time.
class OperatorScript {
 public:
  OperatorScript(std::uint64_t seed, double heal_s) : draw_(seed), heal_s_(heal_s) {}

  /// Every step of the master; what is said goes into `out`.
  void step(const OperatorView& view, Said& out);
  bool pressed() const noexcept { return pressed_; }
  int engages() const noexcept { return engages_; }

 private:
  /// Whoever sees no light lets the button go and presses it again.
  void look_for_light(double now_s, const OperatorView& view);
  void meet_trouble(double now_s, const OperatorView& view, Said& out);

  Draw draw_;
  double heal_s_;
  bool pressed_ = false;
  bool healed_ = false;
  bool engaged_since_heal_ = false;
  int engages_ = 0;
  std::optional<double> unready_since_s_;
  std::optional<double> dark_since_s_;
  std::optional<double> trouble_since_s_;
  double patience_s_ = 0.0;
  double release_at_s_ = -1.0;
  double press_at_s_ = -1.0;
};

}  // namespace telekerf::experiments
