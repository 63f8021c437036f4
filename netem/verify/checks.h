// SPDX-License-Identifier: Apache-2.0
// Measured quantities and the bounds that they must keep.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "netem/verify/bounds.h"

namespace telekerf::netem {

/// One measured quantity. `judged` is false where there is no nominal value to hold it against.
struct Check {
  std::string name;
  std::string unit;
  double measured = 0.0;
  double nominal = 0.0;
  double low = 0.0, high = 0.0;
  bool judged = true;
  bool good() const { return !judged || (measured >= low && measured <= high); }
};

/// The quantities of one run, in the order in which they are looked at.
class Checks {
 public:
  void within(const std::string& name, const std::string& unit, double measured, double nominal, double low,
              double high) {
    checks_.push_back({name, unit, measured, nominal, low, high, true});
  }
  void near(const std::string& name, const std::string& unit, double measured, double nominal,
            double half_width) {
    within(name, unit, measured, nominal, nominal - half_width, nominal + half_width);
  }
  void none(const std::string& name, std::uint64_t count) {
    within(name, "packets", static_cast<double>(count), 0.0, 0.0, 0.0);
  }
  void note(const std::string& name, const std::string& unit, double measured) {
    checks_.push_back({name, unit, measured, 0.0, 0.0, 0.0, false});
  }
  /// A fraction of decisions; `memory`: of the chain that takes them (0: independent).
  void fraction(const std::string& name, std::uint64_t count, std::uint64_t of, double nominal,
                double memory = 0.0) {
    if (of == 0) return;
    if (nominal == 0) return none(name, count);
    const auto n = static_cast<double>(of);
    near(name, "", static_cast<double>(count) / n, nominal,
         bernstein(n, nominal * (1 - nominal), 1.0, memory));
  }
  std::vector<Check> take() { return std::move(checks_); }

 private:
  std::vector<Check> checks_;
};

}  // namespace telekerf::netem
