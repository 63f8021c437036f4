// SPDX-License-Identifier: Apache-2.0
// The start-up error channel: one sentence with its remedy, caught once in main, exit code 2.
#pragma once

#include <stdexcept>
#include <string>

namespace telekerf {

/// "Cannot do it": usage, configuration, input or environment. Never thrown inside a control loop.
class StartupError : public std::runtime_error {
 public:
  explicit StartupError(const std::string& sentence) : std::runtime_error(sentence) {}
};

}  // namespace telekerf
