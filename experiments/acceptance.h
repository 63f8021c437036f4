// SPDX-License-Identifier: Apache-2.0
// Figures that decide an experiment's exit code.
#pragma once

#include <fmt/format.h>

#include <string>

namespace telekerf::experiments {

/// A figure in SI units and what it may be at the most.
struct Acceptance {
  std::string name;
  double value;
  double bar;
  double unit;  ///< factor to the printed unit
  const char* unit_name;

  bool met() const { return value <= bar; }
  void print() const {
    fmt::print("  {:<26}{:>12.4g} {:<5} bar {:g} {}  {}\n", name, unit * value, unit_name, unit * bar,
               unit_name, met() ? "good" : "MISSED");
  }
};

}  // namespace telekerf::experiments
