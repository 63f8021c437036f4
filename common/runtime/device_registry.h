// SPDX-License-Identifier: Apache-2.0
// How a user names one of several devices: NAME, or NAME:REST with what that kind of device needs.
#pragma once

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
    /// What is wrong with the rest, and the remedy; empty: nothing.
    std::string (*validate)(std::string_view rest);
    /// Throws StartupError.
    Device (*open)(std::string_view rest, Needs... needs);
  };

  /// `key`: of the setting.
  constexpr DeviceRegistry(std::string_view key, std::span<const Kind> kinds) : key_(key), kinds_(kinds) {}

  /// How a device may be written, one form after the other.
  std::string forms() const {
    std::string all;
    for (const Kind& kind : kinds_) all.append(all.empty() ? "" : ", ").append(kind.form);
    return all;
  }

  /// What is wrong with a device as a user wrote it, and the remedy; empty: nothing.
  std::string validate(std::string_view device) const {
    if (const Kind* kind = kind_of(device)) return kind->validate(rest_of(device));
    return "must be one of " + forms() + "; docs/how-to says how to add another";
  }

  /// Throws StartupError.
  Device open(std::string_view device, Needs... needs) const {
    if (const std::string wrong = validate(device); !wrong.empty())
      throw configuration_error(std::string(key_).append(" = ").append(device).append(": ").append(wrong));
    return kind_of(device)->open(rest_of(device), needs...);
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

/// Validates a kind that is its name and nothing more.
inline std::string no_argument(std::string_view rest) {
  return rest.empty() ? "" : "stands alone, nothing follows its name";
}

}  // namespace telekerf
