// SPDX-License-Identifier: Apache-2.0
// What is said of a dark beam and a slave that does not follow.
#include "slave/explanation.h"

#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

bool says(const std::string& text, const char* part) { return text.find(part) != text.npos; }

TEST(Explanation, NamesEachGuardThatForbidsAndNoOther) {
  for (std::size_t n = 0; n < laser::kGuardCount; ++n) {
    const std::string said = beam_explanation(std::uint32_t{1} << n, true, false);
    EXPECT_EQ(said, "beam off: " + std::string(laser::kGuards[n].sentence));
  }
  EXPECT_EQ(beam_explanation(laser::guard_bit("stop") | laser::guard_bit("dose"), true, false),
            "beam off: the emergency stop is latched, and this place has got all the energy that it may "
            "(dose_max_j)");
  const std::uint32_t first_two = laser::guard_bit("stop") | laser::guard_bit("fault");
  EXPECT_EQ(beam_explanation(first_two | laser::guard_bit("dose"), true, false),
            "beam off: the emergency stop is latched, and a fault is latched (1 reason more)");
  EXPECT_EQ(beam_explanation(first_two | laser::guard_bit("dose"), false, false),
            "beam off: the emergency stop is latched, and a fault is latched (2 reasons more)");
  EXPECT_TRUE(says(beam_explanation(0, false, false), "beam off: nobody asks for it"));
  EXPECT_EQ(beam_explanation(0, true, true), "beam on");
  EXPECT_EQ(beam_explanation(0, true, false), "beam off: its power is none");
}

TEST(Explanation, SaysOfEachModeWhyItIsNotFollowing) {
  EXPECT_TRUE(says(tracking_explanation(SlaveMode::kWaiting, HoldReason::kNotEngaged, 0, false),
                   "no master has engaged"));
  EXPECT_TRUE(
      says(tracking_explanation(SlaveMode::kHolding, HoldReason::kSilent, 0, false), "no commands arrive"));
  EXPECT_TRUE(
      says(tracking_explanation(SlaveMode::kStopped, HoldReason::kStopped, 0, false), "emergency stop"));
  EXPECT_EQ(tracking_explanation(SlaveMode::kFollowing, HoldReason::kNone, 0, true), "following");
  EXPECT_TRUE(
      says(tracking_explanation(SlaveMode::kFollowing, HoldReason::kNone, 0, false), "still on its way"));
  EXPECT_TRUE(
      says(tracking_explanation(SlaveMode::kFollowing, HoldReason::kNone, laser::guard_bit("sample"), false),
           "has not come"));
}

TEST_F(SlaveNodeTest, AtEachStepItCanBeSaid) {
  EXPECT_TRUE(says(explanation(out_), "not following: no master has engaged"));
  follow(3.0);
  ASSERT_GT(out_.laser_w, 0.0);
  EXPECT_EQ(explanation(out_), "following; beam on");
  pressed_ = [](Tick) { return false; };
  follow(0.1);
  EXPECT_TRUE(out_.laser_w == 0.0 && !out_.button);
  EXPECT_TRUE(says(explanation(out_), "following; beam off: nobody asks for it")) << explanation(out_);
  for (int n = 0; n < 20; ++n) run(std::nullopt);
  EXPECT_TRUE(
      says(explanation(out_), "holding its place: no commands arrive; beam off: the slave does not follow"))
      << explanation(out_);
}

}  // namespace
}  // namespace telekerf::slave
