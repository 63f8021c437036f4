// SPDX-License-Identifier: Apache-2.0
// A cell of real processes for tests of what goes wrong in the field.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/system/programs.h"

namespace telekerf::integration {

inline std::vector<std::string> in_cell(std::vector<std::string> arguments,
                                        const std::string& cell = "field") {
  arguments.insert(arguments.end(), {"--domain", own_domain(), "--cell", cell});
  return arguments;
}

class Field : public testing::Test {
 protected:
  /// No stop of an earlier test holds.
  Field() { std::filesystem::remove_all(Program::scratch() / "state"); }
  static std::unique_ptr<Program> start(const std::string& program,
                                        const std::vector<std::string>& more = {}) {
    return std::make_unique<Program>(program, in_cell(more));
  }
  /// Exit code of telekerf-ctl, and what it said.
  static std::pair<int, std::string> say(const std::vector<std::string>& what,
                                         const std::string& program = "telekerf-ctl") {
    Program said(program, in_cell(what));
    const int code = said.wait(std::chrono::seconds(20));
    return {code, said.output()};
  }
};

}  // namespace telekerf::integration
