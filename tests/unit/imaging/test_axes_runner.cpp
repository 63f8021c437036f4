// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "common/runtime/startup_error.h"
#include "slave/vision/imaging/axes_runner.h"

namespace telekerf::imaging {
namespace {

class Runner : public ::testing::Test {
 protected:
  void run(int steps) {
    for (int i = 0; i < steps; ++i) runner_.step();
  }
  void home() {
    for (int i = 0; i < 20'000 && runner_.state() == AxesControl::State::kHoming; ++i) runner_.step();
    ASSERT_EQ(runner_.state(), AxesControl::State::kReady);
  }

  AxesRunner runner_{open_axes("simulated", {.model = default_axes(), .period_s = 1e-3}), default_axes()};
};

TEST_F(Runner, OrdersGoInAndPositionsComeOut) {
  home();
  runner_.move_to(kMagnification, 0.03);
  runner_.approach(kFocus, 0.012);
  EXPECT_FALSE(runner_.settled());
  run(2500);
  EXPECT_TRUE(runner_.settled(kMagnification));
  EXPECT_TRUE(runner_.settled());
  EXPECT_NEAR(runner_.positions_m().magnification_m, 0.03, 6e-6);
  EXPECT_NEAR(runner_.positions_m().focus_m, 0.012, 6e-6);
  // Behind the play, which is taken up from below.
  EXPECT_NEAR(runner_.optics_m().focus_m, 0.012 - 0.5 * default_axes()[kFocus].backlash_m, 40e-6);
  runner_.drive(kFocus, 5e-3);
  run(200);
  EXPECT_FALSE(runner_.settled());
  EXPECT_NEAR(runner_.positions_m().focus_m, 0.013, 0.2e-3);
}

TEST_F(Runner, AnOrderBeforeHomingIsCarriedOutAfterIt) {
  runner_.move_to(kFocus, 0.009);
  home();
  EXPECT_FALSE(runner_.settled(kFocus));
  run(2000);
  EXPECT_TRUE(runner_.settled(kFocus));
  EXPECT_NEAR(runner_.positions_m().focus_m, 0.009, 6e-6);
}

TEST_F(Runner, ANewOrderIsNotSettledByTheOldOne) {
  home();
  runner_.move_to(kFocus, 0.01);
  run(2000);
  ASSERT_TRUE(runner_.settled(kFocus));
  runner_.move_to(kFocus, 0.01);
  EXPECT_FALSE(runner_.settled(kFocus));  // before the loop has taken it
  run(1);
  EXPECT_TRUE(runner_.settled(kFocus));
}

TEST_F(Runner, AnApproachFromAboveEndsBelowThePlay) {
  home();
  runner_.approach(kFocus, 0.014);
  run(2500);
  const double first_m = runner_.optics_m().focus_m;
  runner_.approach(kFocus, 0.018);
  run(1500);
  runner_.approach(kFocus, 0.014);
  run(2500);
  ASSERT_TRUE(runner_.settled(kFocus));
  EXPECT_NEAR(runner_.optics_m().focus_m, first_m, 8e-6);
}

TEST_F(Runner, CountsItsTimeAndKnowsItsEnds) {
  run(250);
  EXPECT_NEAR(runner_.time_s(), 0.25, 1e-12);
  EXPECT_EQ(runner_.lowest_m(), AxesControl::kMargin_m);
  EXPECT_EQ(runner_.highest_m(kFocus), default_axes()[kFocus].travel_m - AxesControl::kMargin_m);
}

/// Axes that can be silenced, and what they were given last.
struct Shared {
  bool silent = false;
  PerAxis currents{};
};
class Silenced final : public Axes {
 public:
  explicit Silenced(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  AxesReading read() noexcept override {
    axes_.advance(1e-3);
    return shared_->silent ? AxesReading{} : axes_.read();
  }
  void write(const PerAxis& currents_a) noexcept override {
    shared_->currents = currents_a;
    axes_.write(currents_a);
  }

 private:
  std::shared_ptr<Shared> shared_;
  SimulatedAxes axes_{default_axes(), {5e-3, 5e-3}, 0.1, 1};
};

TEST(AxesRunner, WhoHomesAnewHasNotArrivedUntilItIsBack) {
  const auto shared = std::make_shared<Shared>();
  AxesRunner runner({std::make_unique<Silenced>(shared), nullptr}, default_axes());
  runner.move_to(kFocus, 0.01);
  for (int i = 0; i < 8000; ++i) runner.step();
  ASSERT_TRUE(runner.settled());
  shared->silent = true;
  for (int i = 0; i < 60; ++i) runner.step();
  EXPECT_EQ(runner.state(), AxesControl::State::kLost);
  EXPECT_EQ(shared->currents, PerAxis{});
  shared->silent = false;
  for (int i = 0; i < 8000 && runner.state() != AxesControl::State::kReady; ++i) runner.step();
  ASSERT_EQ(runner.state(), AxesControl::State::kReady);
  for (int i = 0; i < 8000 && !runner.settled(); ++i) runner.step();
  ASSERT_TRUE(runner.settled());
  EXPECT_NEAR(runner.positions_m().focus_m, 0.01, 6e-6);
}

TEST(AxesRunner, GivesNoCurrentOnWhatItReadTooLate) {
  const auto shared = std::make_shared<Shared>();
  AxesRunner runner({std::make_unique<Silenced>(shared), nullptr}, default_axes());
  for (int i = 0; i < 100; ++i) runner.step();
  ASSERT_NE(shared->currents, PerAxis{});  // on its way home
  runner.step(true);
  EXPECT_EQ(shared->currents, PerAxis{});
  runner.step();
  EXPECT_NE(shared->currents, PerAxis{});
}

TEST(AxesRunner, StepsByItselfInAThread) {
  AxesRunner runner(open_axes("simulated", {.model = default_axes(), .period_s = 1e-3}), default_axes());
  runner.start();
  for (int i = 0; i < 4000 && runner.state() == AxesControl::State::kHoming; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(runner.state(), AxesControl::State::kReady);
  EXPECT_GT(runner.time_s(), 0.05);
}

TEST(AxesRunner, StepsNoFasterThanTheClock) {
  AxesRunner runner(open_axes("simulated", {.model = default_axes(), .period_s = 1e-3}), default_axes());
  const auto begun = std::chrono::steady_clock::now();
  runner.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const double steps_s = runner.time_s();
  const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begun;
  EXPECT_LE(steps_s, gone.count() + 2.0 * AxesRunner::kPeriod_s);
}

TEST(AxesRunner, LeavesTheMotorsWithoutCurrent) {
  struct Written {
    PerAxis currents{1.0, 1.0};
  };
  class Recorded final : public Axes {
   public:
    explicit Recorded(std::shared_ptr<Written> to) : to_(std::move(to)) {}
    AxesReading read() noexcept override {
      AxesReading reading;
      reading.valid = true;
      reading.tick = ++reads_;
      return reading;
    }
    void write(const PerAxis& currents) noexcept override { to_->currents = currents; }

   private:
    std::shared_ptr<Written> to_;
    std::uint64_t reads_ = 0;
  };
  const auto written = std::make_shared<Written>();
  {
    AxesRunner runner({std::make_unique<Recorded>(written), nullptr}, default_axes());
    for (int i = 0; i < 30; ++i) runner.step();
    EXPECT_NE(written->currents, PerAxis{});  // on its way home
  }
  EXPECT_EQ(written->currents, PerAxis{});
}

TEST(AxesKinds, AreNamedAndRefused) {
  EXPECT_EQ(axes_forms(), "simulated, udp:HOST:PORT");
  EXPECT_EQ(validate_axes("simulated"), "");
  EXPECT_EQ(validate_axes("udp:127.0.0.1:7100"), "");
  EXPECT_NE(validate_axes("udp:127.0.0.1"), "");
  EXPECT_NE(validate_axes("simulated:2"), "");
  EXPECT_NE(validate_axes("canopen"), "");
  EXPECT_THROW(open_axes("canopen", {.model = default_axes(), .period_s = 1e-3}), StartupError);
  EXPECT_NE(open_axes("simulated", {.model = default_axes(), .period_s = 1e-3}).plant, nullptr);
  EXPECT_EQ(open_axes("udp:127.0.0.1:7100", {.model = default_axes(), .period_s = 1e-3}).plant, nullptr);
}

}  // namespace
}  // namespace telekerf::imaging
