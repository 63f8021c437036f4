// SPDX-License-Identifier: Apache-2.0
// How a broken rule is reported.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace telekerf::structure {

/// A line a breach, so that a failure reads as a list of what to do. A breach begins with a file's path.
inline void expect_none(const std::vector<std::string>& breaches) {
  for (const std::string& breach : breaches) ADD_FAILURE() << breach;
}

}  // namespace telekerf::structure
