// SPDX-License-Identifier: Apache-2.0
// How a user names one of several devices: NAME, or NAME:REST with what that kind of device needs.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>

#include "common/runtime/startup_error.h"

namespace telekerf {

/// The kinds that a setting may name. A kind makes a `Device` of the text's rest and of `Needs`.
template <typename Device, typename... Needs>
class DeviceRegistry {
 public:
  /// `rest`: what stands after the first colon.
  struct Kind {
    std::string_view name;  ///< what stands before it
    std::string_view form;  ///< as a user writes it
    /// What the device must be, if it is not; empty: it is.
    std::string (*complaint)(std::string_view rest);
    Device (*attach)(std::string_view rest, Needs... needs);
  };

  /// `key`: of the setting.
  constexpr DeviceRegistry(std::string_view key, std::span<const Kind> kinds) : key_(key), kinds_(kinds) {}

  /// How a device may be written, one form after the other.
  std::string forms() const {
    std::string all;
    for (const Kind& kind : kinds_) all += fmt::format("{}{}", all.empty() ? "" : ", ", kind.form);
    return all;
  }

  /// What is wrong with a device as a user wrote it, and the remedy; empty: nothing.
  std::string complaint(std::string_view device) const {
    if (const Kind* kind = kind_of(device)) return kind->complaint(rest_of(device));
    return fmt::format("must be one of {}; docs/attach-a-drive.md says how to add another", forms());
  }

  /// Throws StartupError.
  Device attach(std::string_view device, Needs... needs) const {
    if (const std::string wrong = complaint(device); !wrong.empty())
      throw StartupError(fmt::format("{} = {}: {}", key_, device, wrong));
    return kind_of(device)->attach(rest_of(device), needs...);
  }

 private:
  const Kind* kind_of(std::string_view device) const {
    for (const Kind& kind : kinds_) {
      if (device.substr(0, device.find(':')) == kind.name) return &kind;
    }
    return nullptr;
  }
  static std::string_view rest_of(std::string_view device) {
    const std::size_t colon = device.find(':');
    return colon == device.npos ? std::string_view() : device.substr(colon + 1);
  }

  std::string_view key_;
  std::span<const Kind> kinds_;
};

/// Of a kind that is its name and nothing more.
inline std::string stands_alone(std::string_view rest) {
  return rest.empty() ? "" : "stands alone, nothing follows its name";
}

}  // namespace telekerf
