// SPDX-License-Identifier: Apache-2.0
// The short form of an experiment, --quick: the same as `telekerf-experiment all --quick` runs of it.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <string>
#include <vector>

#include "common/runtime/settings.h"

namespace telekerf::experiments {

/// Options of an experiment derive from it. What is given beside --quick stays as it is given.
class QuickForm {
 public:
  /// A setting and what it is in the short form.
  struct Shorter {
    std::string setting;
    std::string value;  ///< as the help shows it
    std::function<void()> take;
  };
  template <typename T, typename U>
  static Shorter shorter(const std::string& setting, T& variable, const U& value) {
    return {setting, fmt::format("{}", value), [&variable, value] { variable = value; }};
  }

  /// Declares `quick`; the settings that `shorter` names, and `variable`s, must outlive the loading.
  /// `whole_runs`: settings that hold or write figures of whole runs, and are refused beside it.
  void add_quick(Settings& settings, std::vector<Shorter> shorter = {},
                 std::vector<std::string> whole_runs = {});
  /// Program asks it once the settings are loaded. Throws StartupError.
  void validate() const;

  bool quick = false;

 private:
  const Settings* settings_ =
      nullptr;  // those that were declared last: of a program they are the ones it loads
  std::vector<Shorter> shorter_;
  std::vector<std::string> whole_runs_;
};

}  // namespace telekerf::experiments
