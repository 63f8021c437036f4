// SPDX-License-Identifier: Apache-2.0
// Readings that do not come, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/simulated_axes.h"

namespace telekerf::imaging {
namespace {

/// Axes whose answers stop now and then, as if their process or the network had been held up.
struct Bench {
  explicit Bench(std::uint64_t seed, double missing = 0.0)
      : axes(default_axes(), {12e-3, 8e-3}, 0.2, seed), control(default_axes(), {}), random(seed), loss(missing) {}

  void step() {
    AxesReading reading = axes.read();
    if (silent > 0 || share(random) < loss) reading = {};
    silent = std::max(0, silent - 1);
    const PerAxis currents = control.step(reading);
    axes.write(pushed && !reading.valid ? PerAxis{-0.35, -0.2} : currents);
    axes.advance(1e-3);
    for (const std::size_t axis : kBothAxes) {
      fastest[axis] = std::max(fastest[axis], std::abs(axes.speed_m_per_s(axis)));
      lowest[axis] = std::min(lowest[axis], axes.motor_m(axis));
      highest[axis] = std::max(highest[axis], axes.motor_m(axis));
    }
  }
  void run(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  bool ready(int most = 20'000) {
    for (int i = 0; i < most && control.state() != AxesControl::State::kReady; ++i) step();
    return control.state() == AxesControl::State::kReady;
  }
  bool arrive(int most = 20'000) {
    for (int i = 0; i < most && !control.settled(); ++i) step();
    return control.settled();
  }

  SimulatedAxes axes;
  AxesControl control;
  std::mt19937_64 random;
  std::uniform_real_distribution<double> share{0.0, 1.0};
  double loss;
  bool pushed = false;  ///< downwards by something else while they are silent
  int silent = 0;  ///< readings to come that do not
  PerAxis fastest{};
  PerAxis lowest{1.0, 1.0};
  PerAxis highest{};
};

TEST(AxesGaps, TheZeroIsTheEdgeHoweverManyAnswersAreMissing) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double loss : {0.0, 0.1, 0.4}) {
      Bench bench(seed, loss);
      ASSERT_TRUE(bench.ready()) << seed;
      bench.loss = 0.0;
      ASSERT_TRUE(bench.arrive()) << seed;
      bench.run(200);
      for (const std::size_t axis : kBothAxes)
        EXPECT_NEAR(bench.control.position_m(axis), bench.axes.motor_m(axis), 2.5e-6) << seed << ' ' << loss;
    }
  }
}

TEST(AxesGaps, AnEdgeThatNobodySawIsLookedForAgain) {
  for (const int gap : {4, 20, 45}) {
    Bench bench(3);
    bench.pushed = true;
    int hidden = 0;
    for (int i = 0; i < 20'000 && bench.control.state() != AxesControl::State::kReady; ++i) {
      // Whenever an axis is about to close its switch: three times in all.
      const auto closes = [&](std::size_t axis) {
        const double here_m = bench.axes.motor_m(axis);
        return here_m > 0.0 && here_m + 1e-3 * bench.axes.speed_m_per_s(axis) <= 0.0;
      };
      if (bench.silent == 0 && hidden < 3 && (closes(kMagnification) || closes(kFocus))) {
        bench.silent = gap;
        ++hidden;
      }
      bench.step();
    }
    ASSERT_EQ(hidden, 3);
    ASSERT_EQ(bench.control.state(), AxesControl::State::kReady);
    ASSERT_TRUE(bench.arrive());
    bench.run(200);
    for (const std::size_t axis : kBothAxes)
      EXPECT_NEAR(bench.control.position_m(axis), bench.axes.motor_m(axis), 2.5e-6) << gap;
  }
}

TEST(AxesGaps, NeitherSpeedNorEndsAreExceededAndTheyArrive) {
  const AxesModel model = default_axes();
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    for (const int gap : {30, 60, 200}) {
      Bench bench(seed);
      ASSERT_TRUE(bench.ready());
      ASSERT_TRUE(bench.arrive());
      bench.lowest = {1.0, 1.0};
      for (int way = 0; way < 6; ++way) {
        const auto goal = [&](std::size_t axis) {
          const double top = bench.control.highest_m(axis);
          return way % 2 == 0 ? top - 2e-3 * bench.share(bench.random) : 2e-3 * bench.share(bench.random);
        };
        bench.control.move_to(kMagnification, goal(kMagnification));
        bench.control.approach(kFocus, goal(kFocus));
        for (int gaps = 0; gaps < 4; ++gaps) {
          bench.run(1 + static_cast<int>(500 * bench.share(bench.random)));
          bench.silent = gap;
          bench.run(gap);
        }
        ASSERT_TRUE(bench.arrive()) << seed << ' ' << gap << ' ' << way;
        for (const std::size_t axis : kBothAxes)
          EXPECT_NEAR(bench.axes.motor_m(axis), bench.control.goal_m(axis), 10e-6) << seed << ' ' << gap;
      }
      for (const std::size_t axis : kBothAxes) {
        EXPECT_LT(bench.fastest[axis], 1.1 * model[axis].speed_m_per_s) << seed << ' ' << gap << ' ' << axis;
        EXPECT_GT(bench.lowest[axis], SimulatedAxes::kLowerStop_m) << seed << ' ' << gap << ' ' << axis;
        EXPECT_LT(bench.highest[axis], model[axis].travel_m) << seed << ' ' << gap << ' ' << axis;
      }
    }
  }
}

TEST(AxesGaps, OldReadingsMoveNothing) {
  Bench bench(1);
  ASSERT_TRUE(bench.ready());
  bench.control.move_to(kFocus, 0.02);
  bench.run(300);
  for (int i = 0; i < AxesControl::kMaxBridged; ++i) bench.control.step({});
  EXPECT_EQ(bench.control.step({}), PerAxis{});
  // Nor does a caller that was late itself, at once.
  bench.run(300);
  bench.control.lapse();
  EXPECT_EQ(bench.control.step({}), PerAxis{});
  EXPECT_EQ(bench.control.state(), AxesControl::State::kReady);
  EXPECT_TRUE(bench.arrive());
}

TEST(AxesGaps, LostAxesHomeAnewAndGoWhereTheyWereSent) {
  Bench bench(2);
  ASSERT_TRUE(bench.ready());
  bench.control.move_to(kMagnification, 0.03);
  bench.control.move_to(kFocus, 0.02);
  ASSERT_TRUE(bench.arrive());
  bench.silent = AxesControl::kMaxMissing + 1;
  bench.run(bench.silent);
  EXPECT_EQ(bench.control.state(), AxesControl::State::kLost);
  EXPECT_FALSE(bench.control.settled());
  bench.step();
  EXPECT_EQ(bench.control.state(), AxesControl::State::kHoming);
  bench.lowest = {1.0, 1.0};
  ASSERT_TRUE(bench.ready());
  for (const std::size_t axis : kBothAxes) EXPECT_LE(bench.lowest[axis], 0.0);
  ASSERT_TRUE(bench.arrive());
  EXPECT_NEAR(bench.axes.motor_m(kFocus), 0.02, 10e-6);
  EXPECT_NEAR(bench.axes.motor_m(kMagnification), 0.03, 10e-6);
}

}  // namespace
}  // namespace telekerf::imaging
