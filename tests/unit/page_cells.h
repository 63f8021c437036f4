// SPDX-License-Identifier: Apache-2.0
// A page's cell against what is measured now: its words are the same, its numbers to 2 % and one unit of the
// last digit, as a build for a sanitizer rounds otherwise.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

namespace telekerf {

inline void expect_cell(const std::string& page, const std::string& now, const std::string& where) {
  std::istringstream pages(page);
  std::istringstream nows(now);
  std::string a;
  std::string b;
  while (pages >> a && nows >> b) {
    char* end = nullptr;
    const double value = std::strtod(a.c_str(), &end);
    if (*end != '\0') {
      EXPECT_EQ(a, b) << where;
      continue;
    }
    const std::size_t point = a.find('.');
    const double digit = point == a.npos ? 1.0 : std::pow(10.0, -static_cast<double>(a.size() - point - 1));
    EXPECT_NEAR(value, std::strtod(b.c_str(), nullptr), std::max(1.1 * digit, 0.02 * std::abs(value)))
        << where << ": " << page << " on the page, now " << now;
  }
  EXPECT_TRUE(!(pages >> a) && !(nows >> b)) << where << ": " << page << " on the page, now " << now;
}

}  // namespace telekerf
