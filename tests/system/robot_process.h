// SPDX-License-Identifier: Apache-2.0
// A robot in a process of its own, for stations to be attached to.
#pragma once

#include "tests/system/programs.h"

namespace telekerf::integration {

/// A robot on any free port.
class RobotProcess : public Program {
 public:
  explicit RobotProcess(const std::string& robot)
      : Program("telekerf-robot", {"--robot", robot, "--port", "0"}) {
    const std::string before = "is simulated at ";
    if (!says(before, std::chrono::seconds(20)) || !says("\n", std::chrono::seconds(1))) return;
    const std::string said = output();
    const std::size_t at = said.find(before) + before.size();
    drive_ = said.substr(at, said.find('\n') - at);
  }
  const std::string& drive() const { return drive_; }

 private:
  std::string drive_;
};

}  // namespace telekerf::integration
