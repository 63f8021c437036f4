// SPDX-License-Identifier: Apache-2.0
// What is known of a setting but the variable behind it: help, refusals, the reference page and completion
// are made of this.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/bounds.h"
#include "common/runtime/config.h"

namespace telekerf {

/// What a text stands for.
struct TextForm {
  std::string form;            ///< as a user writes it: FILE, "simulated|udp:HOST:PORT"
  const char* shipped = "";    ///< kind of shipped data that may be named as well ("robots")
  const char* extension = "";  ///< of these
  /// What a text must be, if it is not; empty: it is. Without it what is not shipped must be a path that
  /// exists.
  std::function<std::string(const std::string&)> complaint = {};
};
inline const TextForm kName{"NAME"};
inline const TextForm kFile{"FILE"};
inline const TextForm kFolder{"FOLDER"};
inline const TextForm kPicture{"PICTURE", "pictures", ".png"};
inline const TextForm kRobot{"ROBOT", "robots", ".toml"};
inline const TextForm kProfile{"PROFILE", "profiles", ".toml"};

/// A device as a DeviceRegistry knows it: its forms(), and what validate() says.
TextForm device_form(const std::string& forms, std::function<std::string(const std::string&)> validate);

/// All that is known of a setting but the variable behind it.
struct Setting {
  enum class Type { kSwitch, kNumber, kInteger, kText, kChoice, kNumbers, kTexts };
  struct Choice {
    std::string word;
    std::string sentence;
  };

  std::string name;
  Type type = Type::kText;
  Bounds bounds;                ///< of numbers
  std::vector<Choice> choices;  ///< of kChoice
  TextForm text;                ///< of texts
  std::size_t count = 0;        ///< of numbers in a list, 0: any
  std::string sentence;
  std::optional<ConfigValue> initial;  ///< none: not set, and the sentence says what that means
  /// Read only while another setting of the command is (or is not) one of these words; a number is written
  /// "0".
  struct Condition {
    std::string other;
    std::vector<std::string> words;
    bool among = true;
  };
  std::vector<Condition> conditions;
  std::string prefix;  ///< of its name: `other` is sought with it, and then without
  bool required = false;
  bool may_be_empty = false;  ///< a text
  bool positional = false;    ///< a word on the command line without its flag, and no key

  /// For chaining behind `Settings::add`.
  Setting& must_be_given() {
    required = true;
    return *this;
  }
  Setting& as_argument() {
    positional = true;
    return must_be_given();
  }
  Setting& empty_is_said() {
    may_be_empty = true;
    return *this;
  }
  std::string flag() const;
};

}  // namespace telekerf
