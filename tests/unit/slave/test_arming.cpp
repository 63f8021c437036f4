// SPDX-License-Identifier: Apache-2.0
// What ends an engagement, and what a new one and a released button give back: every cause by itself.
#include "slave/arming.h"

#include <gtest/gtest.h>

#include <functional>

namespace telekerf::slave {
namespace {

constexpr double kDt_s = 1e-3;

class ArmingTest : public testing::Test {
 protected:
  /// A control step in which a sample of engagement `engage` is due.
  bool lead(std::uint32_t engage, bool button = true) {
    now_.newest_engage = std::max(now_.newest_engage, engage);
    sample_.engaged = true;
    sample_.engage = engage;
    sample_.button = button;
    streaming::Played played;
    played.fresh = true;
    played.sample = &sample_;
    played.age_s = age_s_;
    arming_.step(played, now_);
    return !now_.stopped && age_s_ && *age_s_ <= 2.5 && arming_.may_lead(engage);
  }
  void nothing(double seconds) {
    for (int n = 0; n < static_cast<int>(seconds / kDt_s + 0.5); ++n) arming_.step({}, now_);
  }
  void begin() {
    now_.heard = true;
    now_.master_epoch = 7;
    now_.contour_id = 3;
    arming_.step({}, now_);
    ASSERT_TRUE(lead(1, false));
    ASSERT_TRUE(lead(1, false));
    ASSERT_TRUE(lead(1, true));
    ASSERT_TRUE(arming_.armed() && arming_.button_armed());
  }
  void needs_both() {
    EXPECT_FALSE(arming_.armed() || arming_.button_armed());
    EXPECT_FALSE(lead(1, false));
    EXPECT_FALSE(lead(1, true));
    EXPECT_FALSE(arming_.armed() || arming_.button_armed());
    EXPECT_TRUE(lead(2, true));
    EXPECT_TRUE(lead(2, true));
    EXPECT_TRUE(arming_.armed());
    EXPECT_FALSE(arming_.button_armed()) << "a button that was held all the time";
    EXPECT_TRUE(lead(2, false));
    EXPECT_TRUE(lead(2, true));
    EXPECT_TRUE(arming_.button_armed());
  }

  Arming arming_{{}, kDt_s};
  Circumstances now_;
  streaming::StreamSample sample_;
  std::optional<double> age_s_ = 0.1;
};

TEST_F(ArmingTest, NothingLeadsAtTheBeginningAndNothingIsSpent) {
  EXPECT_FALSE(arming_.armed());
  EXPECT_FALSE(arming_.button_armed());
  EXPECT_EQ(arming_.spent(), 0u);
  arming_.step({}, {.contour_id = 3});
  EXPECT_EQ(arming_.spent(), 0u);
}

/// Every number is an epoch: a master is another one until it has been heard, whatever its own is.
TEST_F(ArmingTest, AMasterOfAnyEpochIsAnotherOneWhenItIsHeardFirst) {
  for (const std::uint32_t epoch : {0u, 1u, 0xFFFFFFFFu}) {
    arming_ = Arming({}, kDt_s);
    arming_.step({}, {});
    arming_.step({}, {.heard = true, .master_epoch = epoch, .newest_engage = 1});
    EXPECT_FALSE(arming_.may_lead(1)) << epoch;
    EXPECT_TRUE(arming_.may_lead(2)) << epoch;
  }
}

TEST_F(ArmingTest, WhatIsNotSaidOfAStepIsNothing) {
  arming_.step({}, {.heard = true});
  EXPECT_EQ(arming_.spent(), 0u) << "no engagement has begun";
  now_ = {.heard = true, .master_epoch = 0, .contour_id = 0, .silent_s = 0.0};
  EXPECT_TRUE(lead(1)) << "epoch and contour are still the ones that were not said, and nothing is stopped";
  arming_ = Arming({.beam_age_s = 0.05}, kDt_s);
  arming_.step({}, {.heard = true});
  EXPECT_TRUE(arming_.may_lead(1));
  arming_.step({}, {.heard = true, .newest_engage = 1});
  EXPECT_TRUE(arming_.armed()) << "nor was it silent";
}

TEST_F(ArmingTest, WhatLedBeforeTheMasterWasHeardLeadsNoMore) {
  now_ = {.heard = true, .master_epoch = 7, .newest_engage = 1};
  EXPECT_FALSE(lead(1));
  needs_both();
}

TEST_F(ArmingTest, CommandsOfJustTheLargestAgeAreNoOutage) {
  begin();
  age_s_ = 2.5;
  for (int n = 0; n < 600; ++n) EXPECT_TRUE(lead(1));
  EXPECT_TRUE(arming_.armed());
}

TEST_F(ArmingTest, ASilenceOfJustTheGateIsNoOutage) {
  begin();
  now_.silent_s = 0.35;
  EXPECT_TRUE(lead(1));
  now_.silent_s = 0.351;
  EXPECT_FALSE(lead(1));
}

TEST_F(ArmingTest, AStopEndsTheEngagement) {
  begin();
  now_.stopped = true;
  EXPECT_FALSE(lead(1));
  now_.stopped = false;
  needs_both();
}

TEST_F(ArmingTest, AnEngagementThatBeganDuringTheStopIsSpentWithIt) {
  begin();
  now_.stopped = true;
  (void)lead(1);
  EXPECT_FALSE(lead(2));
  now_.stopped = false;
  EXPECT_FALSE(lead(2));
  EXPECT_EQ(arming_.spent(), 2u);
  EXPECT_TRUE(lead(3));
}

TEST_F(ArmingTest, AnotherContourEndsIt) {
  begin();
  now_.contour_id = 4;
  EXPECT_FALSE(lead(1));
  needs_both();
}

TEST_F(ArmingTest, AnotherMasterEndsIt) {
  begin();
  now_.master_epoch = 8;
  EXPECT_FALSE(lead(1));
  needs_both();
}

TEST_F(ArmingTest, AnOutageSpendsAlsoANewerEngagementThanTheOneThatLedLast) {
  begin();
  EXPECT_TRUE(lead(2));
  EXPECT_TRUE(lead(1)) << "played once more";
  nothing(0.352);
  EXPECT_FALSE(lead(2));
  EXPECT_TRUE(lead(3));
  EXPECT_TRUE(lead(4));
  EXPECT_TRUE(lead(5));
  EXPECT_TRUE(lead(4)) << "played once more";
  nothing(0.352);
  EXPECT_FALSE(lead(5));
  EXPECT_TRUE(lead(6));
}

TEST_F(ArmingTest, ANewEngagementUnderAHeldButtonNeedsItReleasedThoughNothingWasSpent) {
  begin();
  EXPECT_TRUE(lead(2, true));
  EXPECT_TRUE(arming_.armed());
  EXPECT_FALSE(arming_.button_armed());
  EXPECT_TRUE(lead(2, true));
  EXPECT_FALSE(arming_.button_armed());
  EXPECT_TRUE(lead(2, false));
  EXPECT_TRUE(lead(2, true));
  EXPECT_TRUE(arming_.button_armed());
}

TEST_F(ArmingTest, AnOutageCountsFromTheEngagementThatItBeganIn) {
  begin();
  for (int n = 0; n < 352 && arming_.armed(); ++n) arming_.step({}, now_);
  EXPECT_FALSE(arming_.armed());
  EXPECT_TRUE(arming_.may_lead(2)) << "in the very step in which the one before was spent";
  nothing(0.349);
  EXPECT_TRUE(arming_.armed());
  nothing(0.003);
  EXPECT_FALSE(arming_.armed());
}

/// With steps that add up to the gate to the last bit.
TEST_F(ArmingTest, AnOutageOfJustTheGateIsNone) {
  constexpr double kStep_s = 1.0 / 1024.0;
  arming_ = Arming({.beam_age_s = 128 * kStep_s}, kStep_s);
  begin();
  for (int n = 0; n < 128; ++n) arming_.step({}, now_);
  EXPECT_TRUE(arming_.armed());
  arming_.step({}, now_);
  EXPECT_FALSE(arming_.armed());
}

TEST_F(ArmingTest, AStopOrAnotherContourWhileNobodyIsHeardEndsItToo) {
  for (const bool stop : {true, false}) {
    arming_ = Arming({}, kDt_s);
    now_ = {};
    begin();
    now_.heard = false;
    now_.stopped = stop;
    now_.contour_id += stop ? 0 : 1;
    arming_.step({}, now_);
    EXPECT_FALSE(arming_.armed());
    now_.heard = true;
    now_.stopped = false;
    EXPECT_FALSE(lead(1)) << stop;
  }
}

TEST_F(ArmingTest, AnotherMastersCountMayBeginLower) {
  begin();
  for (std::uint32_t engage = 2; engage < 9; ++engage) ASSERT_TRUE(lead(engage));
  now_.master_epoch = 8;
  now_.newest_engage = 0;
  arming_.step({}, now_);
  EXPECT_EQ(arming_.spent(), 0u);
  EXPECT_TRUE(lead(1));
}

TEST_F(ArmingTest, AnOutageLongerThanTheBeamsAgeEndsItAndAShorterOneDoesNot) {
  begin();
  nothing(0.349);
  EXPECT_TRUE(lead(1));
  EXPECT_TRUE(arming_.button_armed());
  nothing(0.352);
  needs_both();
}

TEST_F(ArmingTest, ASilenceThatThePlayOutHidesIsAnOutage) {
  begin();
  now_.silent_s = 0.349;
  EXPECT_TRUE(lead(1));
  EXPECT_TRUE(arming_.button_armed());
  now_.silent_s = 0.351;
  EXPECT_FALSE(lead(1));
  now_.silent_s = 0.0;
  needs_both();
}

TEST_F(ArmingTest, ASilenceSpendsAlsoWhatHasNotLedYet) {
  begin();
  now_.newest_engage = 2;
  now_.silent_s = 0.349;
  arming_.step({}, now_);
  EXPECT_EQ(arming_.spent(), 0u);
  now_.newest_engage = 3;  // with the first block after it
  now_.silent_s = 0.351;
  arming_.step({}, now_);
  now_.silent_s = 0.0;
  EXPECT_EQ(arming_.spent(), 3u);
  EXPECT_FALSE(lead(2, false));
  EXPECT_FALSE(lead(3, false));
  EXPECT_TRUE(lead(4, false));
}

TEST_F(ArmingTest, CommandsTooOldToFollowAreAnOutage) {
  begin();
  age_s_ = 2.6;
  for (int n = 0; n < 352; ++n) (void)lead(1);
  age_s_ = 0.1;
  needs_both();
}

TEST_F(ArmingTest, CommandsOfUnknownAgeAreAnOutage) {
  begin();
  age_s_.reset();
  for (int n = 0; n < 352; ++n) (void)lead(1);
  age_s_ = 0.1;
  needs_both();
}

TEST_F(ArmingTest, CommandsTooOldForTheBeamAreFollowedAndTheButtonMustBeReleased) {
  begin();
  age_s_ = 0.351;
  EXPECT_TRUE(lead(1));
  EXPECT_FALSE(arming_.button_armed());
  EXPECT_TRUE(lead(1, false));
  EXPECT_FALSE(arming_.button_armed()) << "a button of before";
  age_s_ = 0.35;
  EXPECT_TRUE(lead(1, true));
  EXPECT_FALSE(arming_.button_armed());
  EXPECT_TRUE(lead(1, false));
  EXPECT_TRUE(lead(1, true));
  EXPECT_TRUE(arming_.button_armed());
}

TEST_F(ArmingTest, AConcealedSampleReleasesNoButton) {
  begin();
  now_.contour_id = 4;
  (void)lead(1);
  EXPECT_TRUE(lead(2, true));
  sample_.concealed = true;
  EXPECT_TRUE(lead(2, false));
  EXPECT_TRUE(lead(2, false));
  EXPECT_FALSE(arming_.button_armed());
}

TEST_F(ArmingTest, TheCountGoesOnAroundItsEnd) {
  now_ = {.heard = true, .master_epoch = 7, .newest_engage = 0xFFFFFFFF};
  arming_.step({}, now_);
  EXPECT_FALSE(arming_.may_lead(0xFFFFFFFF));
  EXPECT_TRUE(arming_.may_lead(0));
  EXPECT_TRUE(arming_.may_lead(1));
}

}  // namespace
}  // namespace telekerf::slave
