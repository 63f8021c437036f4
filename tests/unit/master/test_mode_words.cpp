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

TEST(ModeWords, AHandThatPushesTheToolOffTheLineIsWhyTheBeamWaits) {
  StateHeader slave;
  slave.contour_id = 7;
  slave.mode = SlaveMode::kFollowing;
  EXPECT_STREQ(text_of(MasterMode::kEngaged, &slave, true, 7, false), "engaged: the slave follows");
  EXPECT_NE(std::string(text_of(MasterMode::kEngaged, &slave, true, 7, true)).find("off the line"),
            std::string::npos);
  slave.mode = SlaveMode::kHolding;
  slave.reason = HoldReason::kTooOld;
  EXPECT_EQ(std::string(text_of(MasterMode::kEngaged, &slave, true, 7, true)).find("off the line"),
            std::string::npos)
      << "that is the lesser of two reasons";
}

}  // namespace
}  // namespace telekerf::master
