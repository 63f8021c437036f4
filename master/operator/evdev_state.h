// SPDX-License-Identifier: Apache-2.0
// What the events of a gamepad, a pen, a SpaceMouse or a pedal at this computer say of the hand. No device,
// no clock of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "master/operator/operator_input.h"
#include "master/operator/space_mouse.h"

namespace telekerf::master {

/// An axis as the kernel tells of it.
struct EvdevAxis {
  int smallest = 0;
  int largest = 0;
  int per_mm = 0;  ///< units a millimetre; 0: the device does not say

  /// -1 to 1 over the travel; 0 of an axis that has none.
  double share(int value) const noexcept;
  /// 0 to 1 over the travel.
  double pressed(int value) const noexcept { return 0.5 * (share(value) + 1.0); }
  double metres(int units) const noexcept;
};

struct EvdevTraits {
  enum class Kind : std::uint8_t {
    kPedal,       ///< keys alone: the laser is wanted while any is down
    kGamepad,     ///< a shoulder button holds, the left stick leads, the right trigger fires
    kPen,         ///< touching holds and leads, in true size from where it touched; the barrel's button fires
    kSpaceMouse,  ///< the cap pushed off its middle holds and leads; a button fires
  };
  Kind kind = Kind::kPedal;
  EvdevAxis x, y;
  bool relative = false;             ///< of a SpaceMouse: its axes come as EV_REL
  std::optional<EvdevAxis> trigger;  ///< of a gamepad that has one as an axis
};

std::string_view name_of(EvdevTraits::Kind kind) noexcept;

/// Neither allocates nor throws. What is down at the beginning, or when events were lost, counts only after
/// it has been up once.
class EvdevState {
 public:
  /// A pad's pointer at full stick, and the farthest that it pulls away from the tool: more gives no more
  /// force (arm.h).
  static constexpr double kPadSpeed_m_per_s = 0.04;
  static constexpr double kFarthest_m = 0.012;
  static constexpr double kDeadZone = 0.12;        ///< of the stick: it does not rest in its middle
  static constexpr double kTriggerPoint = 0.5;     ///< of the trigger's travel
  static constexpr double kUnknownTravel_m = 0.1;  ///< of a pen's tablet that does not say its size

  explicit EvdevState(const EvdevTraits& traits, const SpaceMouseSettings& cap = {}) noexcept
      : traits_(traits), cap_(cap, traits.relative) {}

  /// One event; type and code by the kernel's numbers.
  void hear(int type, int code, int value) noexcept;
  /// Events were lost, or the device is gone: nothing is held.
  void lose() noexcept;
  /// The state of all keys as the kernel has it now: whether any that holds or fires is down.
  void confirm(bool any_down) noexcept;
  bool any_down() const noexcept { return holding() || firing(); }

  OperatorSample sample(std::int64_t now_ns) noexcept;
  void answer(const OperatorAnswer& answer) noexcept;
  /// Keys that hold or fire, for whoever asks the kernel for their state.
  static bool counts(EvdevTraits::Kind kind, int key) noexcept;

 private:
  bool holding() const noexcept;
  bool firing() const noexcept;
  OperatorSample sample_cap(std::int64_t now_ns) noexcept;

  EvdevTraits traits_;
  SpaceMouseCap cap_;
  std::uint32_t hold_keys_ = 0;  ///< how many are down
  std::uint32_t fire_keys_ = 0;
  int x_ = 0, y_ = 0, trigger_ = 0;
  bool let_go_ = false;  ///< nothing was down since the beginning, or the loss
  bool led_ = false;     ///< the pointer is that of the present hold
  int touch_x_ = 0, touch_y_ = 0;
  Vec2 touch_m_ = Vec2::Zero();
  Vec2 pointer_m_ = Vec2::Zero();
  Vec2 tool_m_ = Vec2::Zero();
  std::int64_t last_ns_ = 0;
};

}  // namespace telekerf::master
