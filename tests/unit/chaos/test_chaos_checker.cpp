// SPDX-License-Identifier: Apache-2.0
// The checker sees every kind of violation: each is broken once, and nothing else is.
#include <gtest/gtest.h>

#include "experiments/chaos/checker.h"

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A tool that goes along a straight contour at 10 mm/s under a beam that is allowed.
class CheckerOnALine : public testing::Test {
 protected:
  CheckerOnALine() {
    checker_.contour(&line_);
    checker_.button(1 * kMs, false);
    checker_.engaged(2 * kMs);
    checker_.button(3 * kMs, true);
  }

  Observation lit() {
    now_ns_ += kMs;
    place_m_ += 1e-5;
    Observation seen{.now_ns = now_ns_,
                     .tool_m = {place_m_, 0.0, 0.0},
                     .velocity_m_per_s = {1e-2, 0.0, 0.0},
                     .told_w = 10.0,
                     .emitted_w = 10.0,
                     .permitted = true,
                     .age_s = 0.1};
    seen.reference.position_m = seen.tool_m;
    seen.reference.velocity_m_per_s = seen.velocity_m_per_s;
    return seen;
  }
  Observation dark() {
    Observation seen = lit();
    seen.told_w = seen.emitted_w = 0.0;
    seen.permitted = false;
    return seen;
  }
  void go_on(int steps = 20) {
    for (int i = 0; i < steps; ++i) checker_.observe(lit());
  }
  void expect_only(Bar missed) {
    for (const auto& bar : kBarRows)
      EXPECT_EQ(checker_.findings().missed(bar.value), bar.value == missed) << bar.word;
    EXPECT_TRUE(checker_.findings().failed());
  }

  robot::RobotModel model_ = robot::load_robot("slave-keops");
  geometry::NearestIndex line_{geometry::Polyline{{{-0.01, 0.0}, {0.01, 0.0}}, false}};
  Checker checker_{model_, {.corridor_m = 0.5e-3, .gate_s = 0.35, .dose_j = 3.0, .tick_s = 1e-3}};
  std::int64_t now_ns_ = 10 * kMs;
  double place_m_ = -5e-3;
};

TEST_F(CheckerOnALine, FindsNothingWhereNothingIsWrong) {
  go_on(300);
  EXPECT_FALSE(checker_.findings().failed());
  EXPECT_NEAR(checker_.findings().energy_inside_j, 3.0, 1e-9);
  EXPECT_NEAR(checker_.findings().dose_j, 10.0 * 0.25e-3 / 1e-2, 0.06)
      << "10 W at 10 mm/s, five cells of 0.05 mm";
}

TEST_F(CheckerOnALine, SeesEnergyOutsideTheCorridor) {
  go_on();
  Observation seen = lit();
  seen.tool_m.y() = 0.6e-3;
  checker_.afterglow(seen, 1e-3);
  expect_only(Bar::kOutside);
  EXPECT_NEAR(checker_.findings().energy_outside_j, 0.01, 1e-12);
}

TEST_F(CheckerOnALine, SeesEnergyWithoutAnyContour) {
  checker_.contour(nullptr);
  go_on(1);
  expect_only(Bar::kOutside);
}

TEST_F(CheckerOnALine, SeesABeamThatStaysOnOneSpot) {
  go_on();
  const Observation seen = lit();
  for (int i = 0; i < 280; ++i) checker_.afterglow(seen, 1e-3);
  EXPECT_FALSE(checker_.findings().missed(Bar::kDose));
  for (int i = 0; i < 30; ++i) checker_.afterglow(seen, 1e-3);
  expect_only(Bar::kDose);
}

TEST_F(CheckerOnALine, SeesLightAfterTheLastPermit) {
  go_on();
  for (int i = 0; i < 2; ++i) {
    Observation seen = dark();
    seen.emitted_w = 10.0;
    checker_.observe(seen);
  }
  EXPECT_FALSE(checker_.findings().failed()) << "two ticks are allowed";
  Observation seen = dark();
  seen.emitted_w = 10.0;
  checker_.observe(seen);
  expect_only(Bar::kPermit);
}

TEST_F(CheckerOnALine, BooksAStuckLaserApart) {
  go_on();
  Observation seen = dark();
  seen.emitted_w = 10.0;
  seen.stuck = true;
  for (int i = 0; i < 10; ++i) checker_.afterglow(seen, 1e-3);
  EXPECT_FALSE(checker_.findings().failed());
  EXPECT_NEAR(checker_.findings().energy_stuck_j, 0.1, 1e-9);
}

TEST_F(CheckerOnALine, SeesARelightWithoutANewEngage) {
  go_on();
  checker_.needs_restart(now_ns_);
  checker_.observe(dark());
  checker_.button(now_ns_ + kMs, false);
  go_on();
  expect_only(Bar::kRelight);
  EXPECT_EQ(checker_.findings().relights, 1) << "once for each cause";
}

TEST_F(CheckerOnALine, SeesARelightWithTheButtonHeldThroughout) {
  go_on();
  checker_.needs_restart(now_ns_);
  checker_.observe(dark());
  checker_.engaged(now_ns_ + kMs);
  go_on();
  expect_only(Bar::kRelight);
}

TEST_F(CheckerOnALine, TakesADeliberateRestartForNoRelight) {
  go_on();
  checker_.needs_restart(now_ns_);
  checker_.observe(dark());
  checker_.button(now_ns_ + kMs, false);
  checker_.engaged(now_ns_ + kMs);
  now_ns_ += kMs;
  go_on();
  EXPECT_FALSE(checker_.findings().failed());
}

TEST_F(CheckerOnALine, SeesARelightAfterAnOutageBeyondTheGate) {
  go_on(60);
  checker_.heard(now_ns_, now_ns_ - 50 * kMs);
  checker_.observe(dark());
  now_ns_ += 500 * kMs;
  checker_.interrupted();
  checker_.heard(now_ns_, now_ns_ - 50 * kMs);
  go_on();
  expect_only(Bar::kRelight);
}

TEST_F(CheckerOnALine, SeesABeamOnAnOldCommand) {
  go_on();
  Observation seen = lit();
  seen.age_s = 0.351;
  checker_.observe(seen);
  EXPECT_FALSE(checker_.findings().failed()) << "the gate and a tick";
  seen = lit();
  seen.age_s = 0.3525;
  checker_.observe(seen);
  expect_only(Bar::kBeamAge);
}

TEST_F(CheckerOnALine, SeesABeamThatStaysOnAfterItWasDueToGo) {
  go_on();
  checker_.off_is_due();
  go_on(1);
  EXPECT_FALSE(checker_.findings().failed()) << "one tick is allowed";
  go_on(1);
  expect_only(Bar::kLaserOff);
  EXPECT_EQ(checker_.findings().laser_off_ticks, 2);
}

TEST_F(CheckerOnALine, SeesAReferenceThatJumps) {
  go_on();
  Observation seen = lit();
  seen.reference.position_m.y() = 50e-6;
  checker_.observe(seen);
  expect_only(Bar::kJump);
}

TEST_F(CheckerOnALine, SeesAToolThatIsTooFast) {
  model_.limits.velocity_m_per_s = 8e-3;
  Checker strict(model_, {});
  strict.contour(&line_);
  strict.engaged(kMs);
  strict.button(kMs, false);
  strict.observe(lit());
  EXPECT_TRUE(strict.findings().missed(Bar::kLimit));
  EXPECT_EQ(strict.findings().limit_violations, 1);
}

TEST_F(CheckerOnALine, SeesAToolThatLeavesTheWorkspace) {
  go_on();
  checker_.interrupted();
  Observation seen = dark();
  seen.tool_m = {0.0, model_.workspace.radius_m + 1e-3, 0.0};
  checker_.observe(seen);
  expect_only(Bar::kLimit);
}

TEST_F(CheckerOnALine, SeesAToolThatIsThrown) {
  go_on();
  Observation seen = lit();
  seen.velocity_m_per_s.y() = 0.03;
  checker_.observe(seen);
  expect_only(Bar::kLimit);
}

TEST_F(CheckerOnALine, TellsThatALapDidNotGoOn) {
  checker_.not_recovered(now_ns_);
  expect_only(Bar::kRecovery);
}

TEST(BirthRegister, KnowsTheYoungestOfWhatWasMadeUnderATick) {
  BirthRegister births;
  EXPECT_FALSE(births.of(1, 5));
  births.made(1, 5, 100);
  births.made(1, 5, 300);
  births.made(1, 5, 200);
  births.made(2, 5, 900);
  EXPECT_EQ(births.of(1, 5), 300);
  EXPECT_FALSE(births.of(1, 4));
  births.made(1, ~Tick{0}, 1);
  EXPECT_FALSE(births.of(1, ~Tick{0})) << "no memory for what a forger makes up";
}

}  // namespace
}  // namespace telekerf::experiments
