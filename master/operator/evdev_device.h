// SPDX-License-Identifier: Apache-2.0
// Gamepads, pens, SpaceMice and pedals at this computer, by the kernel's event devices (libevdev).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "master/operator/evdev_state.h"
#include "master/operator/operator_input.h"

struct libevdev;

namespace telekerf::master {

/// What a device is by the events that it has; none: neither gamepad, pen, SpaceMouse nor keys.
std::optional<EvdevTraits> traits_of(const libevdev* device);

/// One device, open and without waiting.
class EvdevDevice {
 public:
  /// Throws StartupError: it is not there, no event device, or of no kind that is of use.
  explicit EvdevDevice(const std::string& path);
  ~EvdevDevice();
  EvdevDevice(const EvdevDevice&) = delete;
  EvdevDevice& operator=(const EvdevDevice&) = delete;

  /// From now on nobody else sees its events: a pedal types into no window. Throws StartupError.
  void grab();
  std::string name() const;
  const EvdevTraits& traits() const noexcept { return traits_; }
  struct Event {
    int type = 0, code = 0, value = 0;
  };
  /// What would make of a device at rest what this one was when it was opened.
  std::vector<Event> beginning() const;
  enum class Read : std::uint8_t { kEvent, kNothing, kLost, kGone };
  /// The next one that waits. Neither waits nor throws.
  Read next(Event& event) noexcept;
  /// Asks the kernel, which repeats a key that nobody holds any more: is one down that counts?
  bool kernel_says_down() const noexcept;

 private:
  int fd_ = -1;
  libevdev* device_ = nullptr;
  EvdevTraits traits_;
};

/// The device as a hand, or as the button alone.
class EvdevInput final : public OperatorInput {
 public:
  explicit EvdevInput(std::unique_ptr<EvdevDevice> device, const SpaceMouseSettings& cap = {});
  OperatorSample sample(std::int64_t now_ns) noexcept override;
  void answer(const OperatorAnswer& answer) noexcept override { state_.answer(answer); }

 private:
  std::unique_ptr<EvdevDevice> device_;
  EvdevState state_;
  bool gone_ = false;
  std::int64_t confirmed_ns_ = 0;
};

/// `rest`: the path, as the user wrote it. Throw StartupError; a pedal leads no tool.
std::unique_ptr<OperatorInput> open_evdev_hand(std::string_view rest, const SpaceMouseSettings& cap);
/// The SpaceMouse at that path, or without one the first that there is.
std::unique_ptr<OperatorInput> open_space_mouse(std::string_view rest, const SpaceMouseSettings& cap);
std::unique_ptr<OperatorInput> open_evdev_button(std::string_view rest);
std::string validate_evdev(std::string_view rest);
std::string validate_space_mouse(std::string_view rest);

/// Paths of the event devices of this computer, in the order of their numbers.
std::vector<std::string> event_devices(const std::string& folder = "/dev/input");

}  // namespace telekerf::master
