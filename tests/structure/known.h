// SPDX-License-Identifier: Apache-2.0
// What breaks a rule, and is not known to (known.txt), fails.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "tests/structure/repository.h"

namespace telekerf::structure {

inline bool is_known(const Repository& repository, const std::string& breach) {
  const auto known = lines_of(repository.files.at("tests/structure/known.txt"));
  return std::any_of(known.begin(), known.end(), [&](const std::string& path) {
    return !path.empty() && !path.starts_with('#') && breach.starts_with(path);
  });
}

/// A line a breach, so that a failure reads as a list of what to do. A breach begins with a file's path.
inline void expect_none(const Repository& repository, const std::vector<std::string>& breaches) {
  for (const std::string& breach : breaches) {
    if (is_known(repository, breach))
      std::cout << "known: " << breach << '\n';
    else
      ADD_FAILURE() << breach;
  }
}

}  // namespace telekerf::structure
