// SPDX-License-Identifier: Apache-2.0
#include "master/operator/evdev_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <libevdev/libevdev.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "common/runtime/startup_error.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kConfirm_ns = 2'000'000'000;  ///< a key that stays down this long is asked for anew

[[noreturn]] void refuse(const std::string& path, const std::string& why, const std::string& remedy) {
  throw environment_error(fmt::format("input device {}: {}; {}", path, why, remedy));
}

EvdevAxis axis_of(const libevdev* device, unsigned code) {
  const input_absinfo* const info = libevdev_get_abs_info(device, code);
  return info == nullptr ? EvdevAxis{} : EvdevAxis{info->minimum, info->maximum, info->resolution};
}

/// Translation and rotation of a cap, under the name of its maker or of the one who sold it before.
bool is_space_mouse(const libevdev* device, unsigned type, unsigned first, unsigned last) {
  constexpr int k3Dconnexion = 0x256f, kLogitech = 0x046d;
  const int vendor = libevdev_get_id_vendor(device);
  if (vendor != k3Dconnexion && vendor != kLogitech) return false;
  for (unsigned axis = first; axis <= last; ++axis) {
    if (libevdev_has_event_code(device, type, axis) != 1) return false;
  }
  return true;
}

}  // namespace

std::optional<EvdevTraits> traits_of(const libevdev* device) {
  const auto has = [device](unsigned type, unsigned code) {
    return libevdev_has_event_code(device, type, code) == 1;
  };
  EvdevTraits traits;
  traits.x = axis_of(device, ABS_X);
  traits.y = axis_of(device, ABS_Y);
  const bool axes = has(EV_ABS, ABS_X) && has(EV_ABS, ABS_Y);
  if (axes && has(EV_KEY, BTN_SOUTH) && (has(EV_KEY, BTN_TL) || has(EV_KEY, BTN_TR))) {
    traits.kind = EvdevTraits::Kind::kGamepad;
    if (has(EV_ABS, ABS_RZ)) traits.trigger = axis_of(device, ABS_RZ);
    return traits;
  }
  if (axes && has(EV_KEY, BTN_TOOL_PEN) && has(EV_KEY, BTN_TOUCH)) {
    traits.kind = EvdevTraits::Kind::kPen;
    return traits;
  }
  traits.relative = is_space_mouse(device, EV_REL, REL_X, REL_RZ);
  if (traits.relative || is_space_mouse(device, EV_ABS, ABS_X, ABS_RZ)) {
    traits.kind = EvdevTraits::Kind::kSpaceMouse;
    return traits;
  }
  if (!axes && libevdev_has_event_type(device, EV_KEY) == 1 && libevdev_has_event_type(device, EV_REL) == 0) {
    traits.kind = EvdevTraits::Kind::kPedal;
    return traits;
  }
  return std::nullopt;
}

EvdevDevice::EvdevDevice(const std::string& path)
    : fd_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (fd_ < 0) {
    const int error = errno;
    refuse(path, std::strerror(error),
           error == EACCES ? "its reader must be in the group 'input'"
                           : "telekerf-inspect inputs lists those that are there");
  }
  const int failed = libevdev_new_from_fd(fd_, &device_);
  const std::optional<EvdevTraits> traits = failed < 0 ? std::nullopt : traits_of(device_);
  if (traits) {
    traits_ = *traits;
    return;
  }
  const std::string why = failed < 0
                              ? fmt::format("no event device ({})", std::strerror(-failed))
                              : fmt::format("'{}' is no gamepad, no pen, no SpaceMouse and no pedal", name());
  libevdev_free(device_);
  ::close(fd_);
  refuse(path, why, "telekerf-inspect inputs lists those that are");
}

EvdevDevice::~EvdevDevice() {
  libevdev_free(device_);
  if (fd_ >= 0) ::close(fd_);
}

void EvdevDevice::grab() {
  const int failed = libevdev_grab(device_, LIBEVDEV_GRAB);
  if (failed < 0)
    throw environment_error(fmt::format("input device '{}' belongs to another program ({}); end that program",
                                        name(), std::strerror(-failed)));
}

std::string EvdevDevice::name() const { return libevdev_get_name(device_); }

std::vector<EvdevDevice::Event> EvdevDevice::beginning() const {
  std::vector<Event> events;
  for (const int axis : {ABS_X, ABS_Y, ABS_RZ}) {
    int value = 0;
    if (libevdev_fetch_event_value(device_, EV_ABS, static_cast<unsigned>(axis), &value) == 1)
      events.push_back({EV_ABS, axis, value});
  }
  for (int key = 0; key < KEY_MAX; ++key) {
    if (EvdevState::counts(traits_.kind, key) &&
        libevdev_get_event_value(device_, EV_KEY, static_cast<unsigned>(key)) != 0)
      events.push_back({EV_KEY, key, 1});
  }
  return events;
}

EvdevDevice::Read EvdevDevice::next(Event& event) noexcept {
  input_event raw{};
  const int result = libevdev_next_event(device_, LIBEVDEV_READ_FLAG_NORMAL, &raw);
  if (result == -EAGAIN) return Read::kNothing;
  if (result < 0) return Read::kGone;
  if (result == LIBEVDEV_READ_STATUS_SYNC) return Read::kLost;
  event = {raw.type, raw.code, raw.value};
  return Read::kEvent;
}

bool EvdevDevice::kernel_says_down() const noexcept {
  constexpr std::size_t kBits = 8;
  std::array<unsigned char, KEY_MAX / kBits + 1> keys{};
  if (::ioctl(fd_, EVIOCGKEY(keys.size()), keys.data()) < 0) return false;
  for (std::size_t key = 0; key < KEY_MAX; ++key) {
    if ((keys[key / kBits] >> key % kBits & 1) != 0 &&
        EvdevState::counts(traits_.kind, static_cast<int>(key)))
      return true;
  }
  return false;
}

EvdevInput::EvdevInput(std::unique_ptr<EvdevDevice> device, const SpaceMouseSettings& cap)
    : device_(std::move(device)), state_(device_->traits(), cap) {
  // Whoever holds it down while the program starts has to press it anew.
  for (const EvdevDevice::Event& event : device_->beginning())
    state_.hear(event.type, event.code, event.value);
}

OperatorSample EvdevInput::sample(std::int64_t now_ns) noexcept {
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  EvdevDevice::Event event;
  for (int i = 0; i < kMostAtOnce && !gone_; ++i) {
    const EvdevDevice::Read read = device_->next(event);
    if (read == EvdevDevice::Read::kNothing) break;
    if (read == EvdevDevice::Read::kGone) gone_ = true;
    if (read == EvdevDevice::Read::kLost) state_.lose();
    if (read == EvdevDevice::Read::kEvent) state_.hear(event.type, event.code, event.value);
  }
  if (gone_) return {};
  if (now_ns - confirmed_ns_ >= kConfirm_ns) {
    confirmed_ns_ = now_ns;
    state_.confirm(device_->kernel_says_down());
  }
  return state_.sample(now_ns);
}

std::unique_ptr<OperatorInput> open_evdev_hand(std::string_view rest, const SpaceMouseSettings& cap) {
  auto device = std::make_unique<EvdevDevice>(std::string(rest));
  if (device->traits().kind == EvdevTraits::Kind::kPedal) {
    throw usage_error(
        fmt::format("input device {} ('{}') is a pedal and leads no tool; give it to --button evdev:{}", rest,
                    device->name(), rest));
  }
  device->grab();
  return std::make_unique<EvdevInput>(std::move(device), cap);
}

std::unique_ptr<OperatorInput> open_space_mouse(std::string_view rest, const SpaceMouseSettings& cap) {
  for (const std::string& path : rest.empty() ? event_devices() : std::vector{std::string(rest)}) {
    std::unique_ptr<EvdevDevice> device;
    try {
      device = std::make_unique<EvdevDevice>(path);
    } catch (const StartupError&) {
      if (!rest.empty()) throw;
      continue;  // no SpaceMouse, or not for this user: telekerf-inspect inputs says of each
    }
    if (device->traits().kind == EvdevTraits::Kind::kSpaceMouse) {
      device->grab();  // the daemon of the CAD programs would pull with the same cap
      return std::make_unique<EvdevInput>(std::move(device), cap);
    }
    if (!rest.empty())
      throw usage_error(
          fmt::format("input device {} ('{}') is a {}, no SpaceMouse; give it to --hand evdev:{}", path,
                      device->name(), name_of(device->traits().kind), path));
  }
  throw environment_error(
      "hand = spacemouse: no SpaceMouse is among the event devices of this computer that may be read; plug "
      "it "
      "in; telekerf-inspect inputs lists those that are there");
}

std::unique_ptr<OperatorInput> open_evdev_button(std::string_view rest) {
  auto device = std::make_unique<EvdevDevice>(std::string(rest));
  device->grab();
  return std::make_unique<EvdevInput>(std::move(device));
}

std::string validate_evdev(std::string_view rest) {
  return rest.empty() ? "needs a device behind the colon, such as evdev:/dev/input/event3" : "";
}

std::string validate_space_mouse(std::string_view) { return ""; }

std::vector<std::string> event_devices(const std::string& folder) {
  std::vector<std::pair<int, std::string>> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view kPrefix = "event";
    int number = 0;
    const char* const end = name.data() + name.size();
    if (!name.starts_with(kPrefix)) continue;
    const auto [rest, wrong] = std::from_chars(name.data() + kPrefix.size(), end, number);
    if (wrong == std::errc() && rest == end) found.emplace_back(number, entry.path().string());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> paths;
  for (auto& [number, path] : found) paths.push_back(std::move(path));
  return paths;
}

}  // namespace telekerf::master
