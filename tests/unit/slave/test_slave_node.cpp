// SPDX-License-Identifier: Apache-2.0
// The slave's node against hand-made commands: what it refuses, when the laser may burn, how it stops.
#include <gtest/gtest.h>

#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

TEST_F(SlaveNodeTest, FollowsAndBurnsOnlyOnceItHasArrived) {
  follow(3.0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_TRUE(out_.settled);
  EXPECT_GT(out_.laser_w, 0.0);
  EXPECT_LT((out_.tool_m - place(out_.applied_tick * 1e-3)).norm(), 10e-6);
  EXPECT_LT(largest_step_, 5e-3) << "m/s a tick, the approach included";
}

TEST_F(SlaveNodeTest, ItsBandwidthsAreChosenFromTheRobotUnlessTheyAreGiven) {
  const auto& chosen = station_.node().bandwidths();
  EXPECT_NEAR(chosen.law_rad_per_s, 498.0, 1.0);
  EXPECT_NEAR(chosen.observer_rad_per_s, 2.5 * chosen.law_rad_per_s, 1e-9);
  StationSettings settings;
  settings.node.bandwidth_rad_s = 60.0;
  settings.node.observer_rad_s = 600.0;
  const Station given(settings);
  EXPECT_EQ(given.node().bandwidths().law_rad_per_s, 60.0);
  EXPECT_EQ(given.node().bandwidths().observer_rad_per_s, 600.0);
}

/// Change of the reference's speed in a step, m/s, where it has gone on for 30 ms and is drawn back to where
/// it was led last.
constexpr double kDrawnBack = 8.7e-3;

TEST_F(SlaveNodeTest, DisengagedItHoldsAndTheLaserIsOff) {
  engaged_ = false;
  follow(1.0);
  EXPECT_EQ(out_.mode, SlaveMode::kWaiting);
  EXPECT_EQ(out_.interlock, Interlock::kNotEngaged);
  EXPECT_EQ(laser_ticks_, 0);
  EXPECT_LT(out_.tool_m.norm(), 1e-6);
}

TEST_F(SlaveNodeTest, SilenceStopsTheLaserAtOnceAndTheMotionSmoothly) {
  follow(3.0);
  run(std::nullopt);  // what was buffered is used up
  run(std::nullopt);
  laser_ticks_ = 0;
  for (int i = 0; i < 60; ++i) run(std::nullopt);
  EXPECT_EQ(laser_ticks_, 0);
  EXPECT_EQ(out_.mode, SlaveMode::kHolding);
  EXPECT_EQ(out_.interlock, Interlock::kNotEngaged);
  EXPECT_LT(out_.reference.velocity_m_per_s.norm(), 1e-9);
  EXPECT_LT(largest_step_, kDrawnBack) << "of 10 that the robot may";
  // The stream comes back: without a jump, and not by itself.
  tick_ += 960;
  follow(1.0);
  EXPECT_EQ(out_.mode, SlaveMode::kHolding);
  EXPECT_EQ(out_.reason, HoldReason::kNeedsEngage);
  engage_anew();
  follow(3.0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_TRUE(out_.settled);
  EXPECT_LT(largest_step_, kDrawnBack);
}

TEST_F(SlaveNodeTest, EmergencyStopLatchesUntilItIsCleared) {
  follow(3.0);
  stop_.number = 9;
  run(next_block());
  EXPECT_EQ(out_.stop, 9u);
  laser_ticks_ = 0;
  follow(0.5);
  EXPECT_EQ(out_.mode, SlaveMode::kStopped);
  EXPECT_EQ(out_.interlock, Interlock::kStopped);
  EXPECT_EQ(laser_ticks_, 0);
  EXPECT_LT(out_.reference.velocity_m_per_s.norm(), 2e-6);
  EXPECT_NEAR(largest_step_, 10e-3, 0.1e-3) << "20 mm/s within 2 ms, half of what the robot may";
  largest_step_ = 0.0;
  stop_ = {.number = 0, .cleared = {9}};
  follow(2.0);
  EXPECT_EQ(out_.mode, SlaveMode::kHolding) << "nothing moves by itself";
  EXPECT_EQ(out_.reason, HoldReason::kNeedsEngage);
  EXPECT_EQ(laser_ticks_, 0);
  engage_anew();
  follow(2.0);
  EXPECT_GT(laser_ticks_, 0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_LT(largest_step_, 5.5e-3);
}

TEST_F(SlaveNodeTest, AfterAStopTheToolIsHeldAgainstItsWeightWhereItCameToRest) {
  follow(3.0);
  stop_.number = 9;
  follow(0.5);
  ASSERT_EQ(out_.mode, SlaveMode::kStopped);
  const Vec3 rest_m = out_.tool_m;
  double farthest_m = 0.0;
  for (int n = 0; n < 100; ++n) {
    follow(0.05);
    farthest_m = std::max(farthest_m, (out_.tool_m - rest_m).norm());
    EXPECT_GT(out_.currents_a.norm(), 0.05) << "its weight is held";
  }
  EXPECT_LT(farthest_m, 20e-6);
  EXPECT_EQ(out_.mode, SlaveMode::kStopped);
}

TEST_F(SlaveNodeTest, RefusesAndCountsWhatDoesNotFit) {
  follow(1.0);
  const auto refused = [&] { return station_.node().counters().refused; };
  const auto stale = station_.node().counters().stale;

  CommandBlock other = next_block();
  const CommandBlock good = other;
  other.epoch = 99;  // a second master knocks
  auto before = refused();
  run(other);
  EXPECT_EQ(refused(), before + 1);

  other = next_block();
  other.first_tick += 60'000;  // stamped a minute ahead
  before = refused();
  run(other);
  EXPECT_EQ(refused(), before + 1);

  other = next_block();
  other.contour_id = 5;
  before = refused();
  run(other);
  EXPECT_EQ(refused(), before + 1);

  other = next_block();
  other.payload.size = 3;  // cut off
  before = refused();
  run(other);
  EXPECT_EQ(refused(), before + 1);

  other = next_block();
  run(other);
  run(other);  // repeated
  EXPECT_EQ(station_.node().counters().stale, stale + 1);
  run(good);  // overtaken, but time has stood for it
  EXPECT_EQ(station_.node().counters().stale, stale + 1);
  run(good);
  EXPECT_EQ(station_.node().counters().stale, stale + 2);
  follow(1.0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_LT(largest_step_, kDrawnBack);
}

TEST_F(SlaveNodeTest, ARestartedMasterIsAcceptedAfterSilence) {
  follow(1.0);
  for (int i = 0; i < 20; ++i) run(std::nullopt);
  epoch_ = 8;
  number_ = 0;
  tick_ = 0;
  encoder_ = codec::BlockEncoder(codec::StreamSettings{});
  follow(3.0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_TRUE(out_.settled);
  EXPECT_LT(largest_step_, kDrawnBack);
}

TEST_F(SlaveNodeTest, AnotherSampleRateInMidRunIsFollowedSmoothly) {
  follow(3.0);
  for (const std::uint16_t ticks_per_sample : {std::uint16_t{2}, std::uint16_t{1}}) {
    ticks_per_sample_ = ticks_per_sample;
    for (int b = 0; b < 100; ++b) {
      run(next_block());
      for (int more = 1; more < ticks_per_sample; ++more) run(std::nullopt);
    }
    EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
    EXPECT_TRUE(out_.settled);
    EXPECT_LT((out_.tool_m - place(out_.applied_tick * 1e-3)).norm(), 15e-6);
  }
  EXPECT_EQ(station_.node().counters().refused, 0u);
  EXPECT_LT(largest_step_, 5e-3) << "m/s a tick";
}

TEST_F(SlaveNodeTest, LostBlocksAreCoveredByTheNextPacketsCopies) {
  follow(3.0);
  for (int i = 0; i < 40; ++i) {
    run(next_block());
    run(next_block());
    (void)next_block();  // lost
    run(std::nullopt);
  }
  const auto missed = station_.node().counters().missed_ticks;
  for (int i = 0; i < 20; ++i) {
    run(next_block());
    run(next_block());
    (void)next_block();
    run(std::nullopt);
  }
  EXPECT_EQ(station_.node().counters().missed_ticks, missed)
      << "once losses were seen, the depth waits for the copies";
  EXPECT_EQ(station_.node().counters().lost, 59u) << "the last loss has not been seen yet";
}

TEST_F(SlaveNodeTest, ASilenceWithinThePlayOutsDepthStopsNothing) {
  // Twenty blocks at once every 320 ms, more than twice the time that counts as silence.
  constexpr int kBlocks = 20;
  int stopped = 0;
  for (int burst = 0; burst < 30; ++burst) {
    std::vector<Received<CommandBlock>> arrived;
    arrived.reserve(kBlocks);
    if (burst == 10) engage_anew();
    for (int i = 0; i < kBlocks; ++i) arrived.push_back({next_block(), now_ns_});
    for (int n = 0; n < 16 * kBlocks; ++n, now_ns_ += kMs) {
      out_ = station_.step(now_ns_, corridor_.get(), arrived, {});
      if (out_.state) echo_ = *out_.state;
      arrived.clear();
      if (burst > 20 && out_.mode != SlaveMode::kFollowing) ++stopped;
    }
  }
  EXPECT_EQ(stopped, 0);
  EXPECT_TRUE(out_.settled);
}

TEST_F(SlaveNodeTest, OvertakenBlocksAreUsedWhileTheyCanBe) {
  const auto swapped = [&](int pairs) {
    for (int i = 0; i < pairs; ++i) {
      const CommandBlock first = next_block();
      (void)next_block();  // lost, so that only the first block itself can fill its place
      const CommandBlock third = next_block();
      run(third);
      run(first);
      run(std::nullopt);
    }
  };
  follow(1.0);
  swapped(40);
  const auto missed = station_.node().counters().missed_ticks;
  const auto lost = station_.node().counters().lost;
  swapped(20);
  EXPECT_EQ(station_.node().counters().missed_ticks, missed) << "the depth covers the late ones";
  EXPECT_EQ(station_.node().counters().lost, lost + 20) << "the late ones are not lost";
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
}

TEST_F(SlaveNodeTest, ABlockFromBeforeItJoinedWasNeverLost) {
  const CommandBlock before = next_block();
  run(next_block());
  run(before);
  EXPECT_EQ(station_.node().counters().lost, 0u);
  EXPECT_EQ(station_.node().counters().stale, 1u);
}

}  // namespace
}  // namespace telekerf::slave
