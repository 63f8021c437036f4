// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/operator_script.h"

namespace telekerf::experiments {
namespace {

using Kind = EventMessage::Kind;
using master::MasterMode;

constexpr double kSlaveSilent_s = 0.3;
constexpr double kFirstPatience_s = 0.3;
/// From engaging until the button is seen released and pressed again.
constexpr double kRelease_s = 0.3;
constexpr double kPress_s = 0.6;
/// Without light although the button is held, until it is let go and pressed again.
constexpr double kDark_s = 1.0;
/// From a trouble that has passed by itself until the button is pressed again.
constexpr double kAgain_s = 0.3;
/// Shorter ones nobody sees.
constexpr double kNoticed_s = 0.25;

EventMessage event(Kind kind, double value = 0.0) {
  EventMessage message;
  message.kind = kind;
  message.value = value;
  return message;
}

bool stopped(const OperatorView& view) {
  return view.mode == MasterMode::kStopped ||
         (view.slave != nullptr && view.slave->interlock == Interlock::kStopped);
}

/// The button alone decides.
bool ready(const OperatorView& view) {
  return view.mode == MasterMode::kEngaged && view.slave != nullptr &&
         static_cast<double>(view.now_ns - view.slave_heard_ns) * 1e-9 < kSlaveSilent_s &&
         view.slave->interlock == Interlock::kReady;
}

/// The slave follows, and counts the button only once it was let go.
bool asks_for_release(const OperatorView& view) {
  return view.mode == MasterMode::kEngaged && view.slave != nullptr &&
         view.slave->mode == SlaveMode::kFollowing && (view.slave->guards & kButtonGuard) != 0;
}

bool may_engage(const OperatorView& view) {
  return (view.mode == MasterMode::kGuiding || view.mode == MasterMode::kEngaged) && view.slave != nullptr;
}

}  // namespace

EventMessage engage_event() { return event(Kind::kEngage); }
EventMessage scale_event(double beta) { return event(Kind::kSetBeta, beta); }

void OperatorScript::step(const OperatorView& view, Said& out) {
  const double now_s = static_cast<double>(view.now_ns) * 1e-9;
  if (!healed_ && now_s >= heal_s_) {
    healed_ = true;
    if (trouble_since_s_) patience_s_ = now_s - *trouble_since_s_ + 1.0;
  }
  if (release_at_s_ >= 0.0 && now_s >= release_at_s_) {
    pressed_ = false;
    release_at_s_ = -1.0;
  }
  if (press_at_s_ >= 0.0 && now_s >= press_at_s_) {
    pressed_ = true;
    press_at_s_ = -1.0;
  }
  if (asks_for_release(view)) look_for_light(now_s, view);
  if (ready(view)) {
    if (!pressed_ && press_at_s_ < 0.0) press_at_s_ = now_s + kAgain_s;
    unready_since_s_.reset();
    trouble_since_s_.reset();
    look_for_light(now_s, view);
    return;
  }
  if (!unready_since_s_) unready_since_s_ = now_s;
  if (now_s - *unready_since_s_ < kNoticed_s) return;
  meet_trouble(now_s, view, out);
}

void OperatorScript::look_for_light(double now_s, const OperatorView& view) {
  if (!pressed_ || view.slave->laser_on || press_at_s_ >= 0.0) {
    dark_since_s_.reset();
    return;
  }
  if (!dark_since_s_) dark_since_s_ = now_s;
  if (now_s - *dark_since_s_ < kDark_s) return;
  dark_since_s_.reset();
  release_at_s_ = now_s;
  press_at_s_ = now_s + kRelease_s;
}

void OperatorScript::meet_trouble(double now_s, const OperatorView& view, Said& out) {
  if (!trouble_since_s_) {
    trouble_since_s_ = now_s;
    patience_s_ = healed_ ? 1.0 : engages_ == 0 ? kFirstPatience_s : draw_.factor(0.5, 4.0);
    const bool holds_on = draw_.one_in(4) && !healed_;
    if (!holds_on && press_at_s_ < 0.0) pressed_ = false;
    return;
  }
  if (now_s - *trouble_since_s_ < patience_s_) return;
  if (stopped(view)) {
    out.clear = true;
    patience_s_ = now_s - *trouble_since_s_ + 0.5;
    return;
  }
  if (!may_engage(view) || (healed_ && engaged_since_heal_)) return;
  out.events.push_back(engage_event());
  ++engages_;
  engaged_since_heal_ = healed_;
  release_at_s_ = now_s + kRelease_s;
  press_at_s_ = now_s + kPress_s;
  trouble_since_s_ = now_s;
  patience_s_ = 2.5;
}

}  // namespace telekerf::experiments
