// SPDX-License-Identifier: Apache-2.0
// When the slave is led and let go, and by which law: bounds, counts and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "master/engagement.h"
#include "master/law.h"

namespace telekerf::master {
namespace {

constexpr double kH = 1e-3;
using Phase = Engagement::Phase;

class EngagementTest : public testing::Test {
 protected:
  /// As many samples of a command index, applied or not.
  void told(int count, std::int64_t index, bool applied, bool ours = true) {
    const std::vector<streaming::SlaveSample> samples(static_cast<std::size_t>(count),
                                                      {index, 0, applied, Vec3(1e-3, 2e-3, 0), Vec3::Zero()});
    engagement_.received(samples, ours);
  }
  void engage() {
    told(1, 0, false);
    ASSERT_EQ(engagement_.begin_block(100, true), Phase::kBegins);
  }

  Engagement engagement_{{.rate_rad_per_s = 20.0, .max_acceleration_m_per_s2 = 1.0}, kH};
};

TEST_F(EngagementTest, BeginsOnlyWhereTheSlaveWasSeenAndIsWantedAndGoesOn) {
  EXPECT_EQ(engagement_.begin_block(0, true), Phase::kApart) << "nobody was seen";
  engagement_.received({}, true);
  EXPECT_FALSE(engagement_.slave_m());
  told(1, 0, false, false);
  ASSERT_TRUE(engagement_.slave_m()) << "seen, although it follows another master";
  EXPECT_EQ(*engagement_.slave_m(), Vec3(1e-3, 2e-3, 0));
  EXPECT_EQ(engagement_.begin_block(16, false), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block(32, true), Phase::kBegins);
  EXPECT_TRUE(engagement_.engaged());
  EXPECT_EQ(engagement_.begin_block(48, true), Phase::kHolds);
  EXPECT_EQ(engagement_.begin_block(64, false), Phase::kApart);
  EXPECT_FALSE(engagement_.engaged());
  EXPECT_EQ(engagement_.begin_block(80, true), Phase::kBegins);
}

TEST_F(EngagementTest, UnaidedItIsWhatIsWanted) {
  EXPECT_EQ(engagement_.begin_block_unaided(false), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block_unaided(true), Phase::kBegins);
  EXPECT_TRUE(engagement_.engaged());
  EXPECT_EQ(engagement_.begin_block_unaided(true), Phase::kHolds);
  EXPECT_EQ(engagement_.begin_block_unaided(false), Phase::kApart);
  EXPECT_FALSE(engagement_.engaged());
}

TEST_F(EngagementTest, WhoHasAppliedNothingForSixTenthsOfASecondIsReleasedForTwo) {
  engage();
  told(1, 101, true);
  told(600, 101, false);
  EXPECT_EQ(engagement_.begin_block(800, true), Phase::kHolds) << "not yet";
  told(1, 101, false);
  EXPECT_EQ(engagement_.begin_block(816, true), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block(816 + 199, true), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block(816 + 200, true), Phase::kBegins);
  told(600, 1017, false);
  EXPECT_EQ(engagement_.begin_block(1700, true), Phase::kHolds) << "counted anew";
}

// The first answer takes a round trip, 0.6 s and more over a satellite.
TEST_F(EngagementTest, WhoHasNotAnsweredYetIsGivenFiveSeconds) {
  engage();
  told(5000, 101, false);
  EXPECT_EQ(engagement_.begin_block(5200, true), Phase::kHolds) << "not yet";
  told(1, 101, false);
  EXPECT_EQ(engagement_.begin_block(5216, true), Phase::kApart);
}

TEST_F(EngagementTest, OnlySamplesOfThisEngagementCountAndOneThatWasAppliedEndsTheCount) {
  engage();
  told(1000, 100, false);  // of what was sent before it began
  EXPECT_EQ(engagement_.begin_block(516, true), Phase::kHolds);
  told(1000, 101, false, false);  // another master's
  EXPECT_EQ(engagement_.begin_block(532, true), Phase::kHolds);
  told(550, 101, false);
  told(1, 101, true);
  told(550, 101, false);
  EXPECT_EQ(engagement_.begin_block(548, true), Phase::kHolds);
  told(51, 101, false);
  EXPECT_EQ(engagement_.begin_block(564, false), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block(580, true), Phase::kApart) << "let go by itself, and released as well";
}

TEST_F(EngagementTest, AnEngagementBeginsItsCountAnew) {
  engage();
  told(500, 101, false);
  EXPECT_EQ(engagement_.begin_block(200, false), Phase::kApart);
  EXPECT_EQ(engagement_.begin_block(216, true), Phase::kBegins);
  told(500, 217, false);
  EXPECT_EQ(engagement_.begin_block(600, true), Phase::kHolds);
}

TEST_F(EngagementTest, TheLastSevenBlocksAreRememberedTheNewestFirst) {
  for (const bool engaged : {true, true, false, true, false, false, true, false, true})
    engagement_.finish_block(engaged);
  EXPECT_EQ(engagement_.engaged_before(), 0b0100101);
  engagement_.finish_block(true);
  EXPECT_EQ(engagement_.engaged_before(), 0b1001011);
  engagement_.forget_blocks();
  EXPECT_EQ(engagement_.engaged_before(), 0);
}

TEST_F(EngagementTest, AnApproachBeginsAtTheSlaveAndEndsWithin2Micrometres) {
  const KinematicState source;
  const KinematicState from{.position_m = Vec3(1e-3, 0, 0)};
  engagement_.approach(from, source);
  KinematicState goal = engagement_.goal(source, from);
  EXPECT_LT((goal.position_m - from.position_m).norm(), 1e-15) << "at its very sample nothing has faded";
  bool aligned = false;
  for (int n = 1; n < 2000; ++n) {
    goal = engagement_.goal(source, goal);
    const double left_m = 1e-3 * (1 + 20 * n * kH) * std::exp(-20 * n * kH);
    ASSERT_NEAR(goal.position_m.x(), left_m, 1e-12) << n;
    ASSERT_EQ(engagement_.aligned(), left_m < 2e-6) << n;
    aligned = engagement_.aligned();
  }
  EXPECT_TRUE(aligned);
}

TEST_F(EngagementTest, ASlaveTwoMillimetresOffIsApproachedAnew) {
  const KinematicState source;
  for (const double off_m : {1.999e-3, 2.001e-3}) {
    const KinematicState predicted{.position_m = Vec3(0, off_m, 0)};
    engagement_ = Engagement({.rate_rad_per_s = 20.0, .max_acceleration_m_per_s2 = 1.0}, kH);
    const KinematicState goal = engagement_.goal(source, predicted);
    EXPECT_NEAR(goal.position_m.y(), off_m > 2e-3 ? off_m : 0.0, 1e-15) << off_m;
  }
  const KinematicState nowhere{.position_m = Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
  EXPECT_FALSE(engagement_.goal(source, nowhere).position_m.allFinite()) << "not taken for near";
}

TEST(LawBandwidth, AcrossTheDelayIsHalfOfWhatTheTimingErrorAllows) {
  LawSettings settings;
  EXPECT_EQ(law_bandwidth(settings, 0.5), settings.tracking_rad_s)
      << "the slave's own loop follows the anchors";
  settings.law = Law::kRemoteAcceleration;
  for (const double delay_s : {0.05, 0.1, 0.4}) {
    const double w = law_bandwidth(settings, delay_s);
    EXPECT_NEAR(settings.timing_error_s * (2 * w + w * w * delay_s), 0.5, 1e-12) << delay_s;
  }
  settings.tracking_rad_s = 150.0;
  EXPECT_EQ(law_bandwidth(settings, 1e-3), 150.0) << "no more than the law was given";
}

TEST(CommandedAcceleration, IsTheTrackingLawLessTheDisturbanceAndClipped) {
  const LawSettings settings;
  const KinematicState goal{Vec3(1e-3, 0, 0), Vec3(0, 2e-3, 0), Vec3(0, 0, 0.5)};
  const KinematicState slave{Vec3(0, 1e-4, 0), Vec3(1e-3, 0, 0), Vec3(9, 9, 9)};
  const Vec3 disturbance(0.1, -0.2, 0.3);
  const Vec3 wanted(100 * 1e-3 - 20 * 1e-3 - 0.1, 20 * 2e-3 - 100 * 1e-4 + 0.2, 0.5 - 0.3);
  EXPECT_LT((commanded_acceleration(settings, 10.0, goal, slave, disturbance) - wanted).norm(), 1e-12);
  const Vec3 clipped = commanded_acceleration(settings, 200.0, goal, slave, disturbance);
  EXPECT_NEAR(clipped.norm(), settings.max_acceleration_m_per_s2, 1e-12);
  EXPECT_GT(clipped.x(), 9.5);
  const Vec3 nonsense = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(commanded_acceleration(settings, 10.0, goal, slave, nonsense), Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace telekerf::master
