// SPDX-License-Identifier: Apache-2.0
#include "master/operator/evdev_state.h"

#include <linux/input-event-codes.h>

#include <algorithm>

namespace telekerf::master {
namespace {

/// A step that was missed moves no pointer.
constexpr double kLongestStep_s = 0.01;

bool is_hold_key(EvdevTraits::Kind kind, int key) noexcept {
  switch (kind) {
    case EvdevTraits::Kind::kGamepad:
      return key == BTN_TL || key == BTN_TR;
    case EvdevTraits::Kind::kPen:
      return key == BTN_TOUCH;
    case EvdevTraits::Kind::kSpaceMouse:
    case EvdevTraits::Kind::kPedal:
      break;
  }
  return false;
}

bool is_fire_key(EvdevTraits::Kind kind, int key) noexcept {
  switch (kind) {
    case EvdevTraits::Kind::kGamepad:
      return key == BTN_TR2;
    case EvdevTraits::Kind::kPen:
      return key == BTN_STYLUS || key == BTN_STYLUS2;
    case EvdevTraits::Kind::kSpaceMouse:
      return key == BTN_0 || key == BTN_1;
    case EvdevTraits::Kind::kPedal:
      return true;
  }
  return false;
}

void count(std::uint32_t& keys, int value) noexcept {
  if (value == 1) ++keys;
  if (value == 0 && keys > 0) --keys;
  // 2 is the kernel's own repetition: no sign of life.
}

}  // namespace

double EvdevAxis::share(int value) const noexcept {
  if (largest <= smallest) return 0.0;
  const double middle = 0.5 * (static_cast<double>(smallest) + largest);
  return std::clamp(2.0 * (value - middle) / (static_cast<double>(largest) - smallest), -1.0, 1.0);
}

double EvdevAxis::metres(int units) const noexcept {
  if (per_mm > 0) return 1e-3 * units / per_mm;
  if (largest <= smallest) return 0.0;
  return EvdevState::kUnknownTravel_m * units / (static_cast<double>(largest) - smallest);
}

std::string_view name_of(EvdevTraits::Kind kind) noexcept {
  switch (kind) {
    case EvdevTraits::Kind::kPedal:
      return "pedal";
    case EvdevTraits::Kind::kGamepad:
      return "gamepad";
    case EvdevTraits::Kind::kPen:
      return "pen";
    case EvdevTraits::Kind::kSpaceMouse:
      return "SpaceMouse";
  }
  return "unknown";
}

bool EvdevState::counts(EvdevTraits::Kind kind, int key) noexcept {
  return is_hold_key(kind, key) || is_fire_key(kind, key);
}

bool EvdevState::holding() const noexcept { return hold_keys_ > 0; }

bool EvdevState::firing() const noexcept {
  return fire_keys_ > 0 || (traits_.trigger && traits_.trigger->pressed(trigger_) > kTriggerPoint);
}

void EvdevState::hear(int type, int code, int value) noexcept {
  if (type == EV_SYN && code == SYN_DROPPED) return lose();
  if (type == EV_KEY && is_hold_key(traits_.kind, code)) count(hold_keys_, value);
  if (type == EV_KEY && is_fire_key(traits_.kind, code)) count(fire_keys_, value);
  if (type == EV_ABS && code == ABS_X) x_ = value;
  if (type == EV_ABS && code == ABS_Y) y_ = value;
  if (type == EV_ABS && code == ABS_RZ && traits_.trigger) trigger_ = value;
  if (traits_.kind == EvdevTraits::Kind::kSpaceMouse) cap_.hear(type, code, value);
}

void EvdevState::lose() noexcept {
  let_go_ = false;
  led_ = false;
  cap_.lose();
}

void EvdevState::confirm(bool down) noexcept {
  if (down) return;
  hold_keys_ = 0;
  fire_keys_ = 0;
}

OperatorSample EvdevState::sample_cap(std::int64_t now_ns) noexcept {
  const std::optional<Vec2> pull_m = cap_.pull_m(now_ns);
  let_go_ = let_go_ || (!pull_m && !firing());
  OperatorSample sample;
  if (!let_go_ || !pull_m) return sample;
  sample.held = true;
  sample.trigger = firing();
  sample.pointer_m = tool_m_ + *pull_m;
  return sample;
}

OperatorSample EvdevState::sample(std::int64_t now_ns) noexcept {
  if (traits_.kind == EvdevTraits::Kind::kSpaceMouse) return sample_cap(now_ns);
  const double step_s = std::clamp(static_cast<double>(now_ns - last_ns_) * 1e-9, 0.0, kLongestStep_s);
  last_ns_ = now_ns;
  let_go_ = let_go_ || !any_down();
  OperatorSample sample;
  if (!let_go_) return sample;
  sample.trigger = firing() && (traits_.kind == EvdevTraits::Kind::kPedal || holding());
  if (!holding()) {
    led_ = false;
    return sample;
  }
  if (!led_) {
    led_ = true;
    pointer_m_ = touch_m_ = tool_m_;
    touch_x_ = x_;
    touch_y_ = y_;
  }
  // The kernel counts y downwards.
  if (traits_.kind == EvdevTraits::Kind::kPen) {
    pointer_m_ = touch_m_ + Vec2(traits_.x.metres(x_ - touch_x_), -traits_.y.metres(y_ - touch_y_));
  } else {
    const Vec2 stick(traits_.x.share(x_), -traits_.y.share(y_));
    if (stick.norm() > kDeadZone) pointer_m_ += step_s * kPadSpeed_m_per_s * stick;
    const Vec2 pull_m = pointer_m_ - tool_m_;
    if (pull_m.norm() > kFarthest_m) pointer_m_ = tool_m_ + kFarthest_m * pull_m.normalized();
  }
  sample.held = true;
  sample.pointer_m = pointer_m_;
  return sample;
}

void EvdevState::answer(const OperatorAnswer& answer) noexcept { tool_m_ = answer.tool_m; }

}  // namespace telekerf::master
