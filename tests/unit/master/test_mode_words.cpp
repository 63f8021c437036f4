// SPDX-License-Identifier: Apache-2.0
// What the master says that it does.
#include <gtest/gtest.h>

#include <string>

#include "master/mode_words.h"

namespace telekerf::master {
namespace {

TEST(ModeWords, ASlaveWithoutThisContourIsWhyItDoesNotFollow) {
  StateHeader slave;
  const auto says = [&](std::uint32_t of_slave, const char* what) {
    slave.contour_id = of_slave;
    const std::string said = text_of(MasterMode::kGuiding, &slave, true, 7);
    return said.find(what) != std::string::npos;
  };
  EXPECT_TRUE(says(7, "the slave does not follow"));
  EXPECT_TRUE(says(8, "the slave works on another contour than this side"));
  EXPECT_TRUE(says(0, "the slave has no contour"));
  EXPECT_STREQ(text_of(MasterMode::kGuiding, nullptr, false, 7),
               "guiding the hand; the slave does not follow");
  slave.contour_id = 8;
  EXPECT_STREQ(text_of(MasterMode::kStopped, &slave, true, 7), "stopped");
}

}  // namespace
}  // namespace telekerf::master
