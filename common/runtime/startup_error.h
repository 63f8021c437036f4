// SPDX-License-Identifier: Apache-2.0
// The start-up error channel: one sentence with its remedy, caught once in main, exit code 2.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace telekerf {

/// Who can mend it.
enum class ErrorKind : std::uint8_t {
  kUsage,          ///< the command line: an option, a value, a combination of them
  kConfiguration,  ///< a configuration, robot or profile file, or settings that do not go together
  kInput,          ///< what is worked on: a picture, a contour, a recording
  kEnvironment,    ///< this computer and the others: folders, network, rights, who else runs
  kHardware,       ///< a robot, laser, camera or button that is not there or was lost
};

/// "Cannot do it". Never thrown inside a control loop.
class StartupError : public std::runtime_error {
 public:
  StartupError(ErrorKind kind, const std::string& sentence) : std::runtime_error(sentence), kind_(kind) {}
  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

inline StartupError usage_error(const std::string& sentence) { return {ErrorKind::kUsage, sentence}; }
inline StartupError configuration_error(const std::string& sentence) {
  return {ErrorKind::kConfiguration, sentence};
}
inline StartupError input_error(const std::string& sentence) { return {ErrorKind::kInput, sentence}; }
inline StartupError environment_error(const std::string& sentence) {
  return {ErrorKind::kEnvironment, sentence};
}
inline StartupError hardware_error(const std::string& sentence) { return {ErrorKind::kHardware, sentence}; }

}  // namespace telekerf
