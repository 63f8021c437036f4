// SPDX-License-Identifier: Apache-2.0
// A SpaceMouse by the events that the kernel tells of it, without a device: as new kernels do (EV_ABS), and
// old ones (EV_REL).
#include <gtest/gtest.h>
#include <libevdev/libevdev.h>
#include <linux/input-event-codes.h>

#include <memory>
#include <random>
#include <string>

#include "common/runtime/startup_error.h"
#include "master/operator/evdev_device.h"
#include "master/operator/evdev_state.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr SpaceMouseSettings kCap{.mm_per_count = 0.01, .dead_counts = 20};

class Mouse {
 public:
  explicit Mouse(bool relative)
      : state({.kind = EvdevTraits::Kind::kSpaceMouse, .x = {}, .y = {}, .relative = relative, .trigger = {}},
              kCap),
        relative_(relative) {}
  /// One report; the kernel leaves out a relative zero, and an absolute value that is as before.
  void report(int x, int y, int z = 0) {
    bool any = false;
    int axis = 0;
    for (const int value : {x, y, z}) {
      const bool told = relative_ ? value != 0 : value != last_[axis];
      if (told) state.hear(relative_ ? EV_REL : EV_ABS, axis, value);
      any = any || told;
      last_[axis++] = value;
    }
    if (any) state.hear(EV_SYN, SYN_REPORT, 0);
  }
  void turn(int value) {
    state.hear(relative_ ? EV_REL : EV_ABS, relative_ ? REL_RX : ABS_RX, value);
    state.hear(EV_SYN, SYN_REPORT, 0);
  }
  OperatorSample step(int steps = 1) {
    OperatorSample sample;
    for (int n = 0; n < steps; ++n) sample = state.sample(now_ns += kMs);
    return sample;
  }
  /// A cap in a hand: reports at 100 Hz, trembling.
  OperatorSample hold(int x, int y, int ms) {
    OperatorSample sample;
    for (int n = 0; n < ms; n += 10) {
      report(x, y, 1 + n / 10 % 2);
      sample = step(10);
    }
    return sample;
  }

  EvdevState state;
  std::int64_t now_ns = 1000 * kMs;

 private:
  bool relative_;
  int last_[3] = {};
};

class SpaceMouse : public testing::TestWithParam<bool> {
 protected:
  Mouse mouse{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Kernels, SpaceMouse, testing::Bool(),
                         [](const auto& which) { return which.param ? "Relative" : "Absolute"; });

TEST_P(SpaceMouse, PullsTheToolTheWayItsCapIsPushed) {
  mouse.step();
  mouse.state.answer({.now_ns = 0, .guided = true, .tool_m = Vec2(0.01, 0.02)});
  const OperatorSample right = mouse.hold(220, 0, 50);
  ASSERT_TRUE(right.held && right.pointer_m);
  EXPECT_NEAR(right.pointer_m->x(), 0.01 + 200 * 0.01e-3, 1e-9) << "the dead zone does not count";
  EXPECT_NEAR(right.pointer_m->y(), 0.02, 1e-9);
  EXPECT_FALSE(right.trigger);
  const OperatorSample away = mouse.hold(0, -120, 50);
  EXPECT_NEAR(away.pointer_m->y(), 0.02 + 100 * 0.01e-3, 1e-9) << "the kernel counts y towards the operator";
  EXPECT_NEAR(away.pointer_m->x(), 0.01, 1e-9);
}

TEST_P(SpaceMouse, HoldsNothingWithinItsDeadZone) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> rest(-14, 14);
  for (int n = 0; n < 500; ++n) EXPECT_FALSE(mouse.hold(rest(random), rest(random), 10).held);
}

TEST_P(SpaceMouse, SilenceLetsGo) {
  mouse.step();
  ASSERT_TRUE(mouse.hold(200, 100, 100).held);
  const OperatorSample still = mouse.step(85);
  EXPECT_TRUE(still.held) << "95 ms after its last report";
  const OperatorSample silent = mouse.step(10);
  EXPECT_FALSE(silent.held);
  EXPECT_FALSE(silent.pointer_m);
}

TEST_P(SpaceMouse, AButtonFiresOnlyWhileTheCapPulls) {
  mouse.step();
  mouse.state.hear(EV_KEY, BTN_0, 1);
  EXPECT_FALSE(mouse.step().trigger);
  EXPECT_TRUE(mouse.hold(200, 0, 30).trigger);
  mouse.state.hear(EV_KEY, BTN_0, 0);
  EXPECT_FALSE(mouse.hold(200, 0, 30).trigger);
}

TEST_P(SpaceMouse, AButtonThatWasDownAtTheBeginningCountsOnlyAfterItWasUp) {
  mouse.state.hear(EV_KEY, BTN_1, 1);
  EXPECT_FALSE(mouse.hold(200, 0, 300).held);
  mouse.state.hear(EV_KEY, BTN_1, 0);
  mouse.step(200);
  mouse.report(0, 0);
  mouse.step();
  EXPECT_TRUE(mouse.hold(200, 0, 30).held);
}

TEST_P(SpaceMouse, LostEventsLetGoUntilItHasBeenAtRest) {
  mouse.step();
  ASSERT_TRUE(mouse.hold(200, 0, 30).held);
  mouse.state.hear(EV_SYN, SYN_DROPPED, 0);
  EXPECT_FALSE(mouse.hold(200, 0, 300).held);
  mouse.report(0, 0);
  mouse.step(150);
  EXPECT_TRUE(mouse.hold(200, 0, 30).held);
}

TEST(SpaceMouseAbsolute, AfterASilenceWhilePushedItHasToComeToRestOnce) {
  Mouse mouse(false);
  mouse.step();
  ASSERT_TRUE(mouse.hold(300, 0, 50).held);
  mouse.step(500);  // its radio is gone
  EXPECT_FALSE(mouse.hold(310, 0, 300).held);
  mouse.report(0, 0);
  mouse.step();
  EXPECT_TRUE(mouse.hold(300, 0, 30).held);
}

TEST(SpaceMouseAbsolute, PushedAtTheBeginningItHasToComeToRestOnce) {
  Mouse mouse(false);
  EXPECT_FALSE(mouse.hold(300, 0, 300).held);
  mouse.report(0, 0);
  mouse.step();
  EXPECT_TRUE(mouse.hold(300, 0, 30).held);
}

TEST(SpaceMouseRelative, AnAxisThatAReportLeavesOutIsAtRest) {
  Mouse mouse(true);
  mouse.step();
  ASSERT_TRUE(mouse.hold(200, 200, 30).held);
  EXPECT_NEAR(mouse.hold(200, 0, 30).pointer_m->y(), 0.0, 1e-12);
}

TEST(SpaceMouseRelative, TurningTheCapKeepsNoTranslationAlive) {
  Mouse mouse(true);
  mouse.step();
  ASSERT_TRUE(mouse.hold(200, 0, 30).held);
  for (int n = 0; n < 12; ++n) {
    mouse.turn(150 + n);
    mouse.step(10);
  }
  EXPECT_FALSE(mouse.step().held) << "its rest is never told";
}

/// A device that the kernel might show.
class Shown {
 public:
  Shown(int vendor, unsigned type, unsigned first, unsigned last) {
    libevdev_set_id_vendor(device_.get(), vendor);
    libevdev_enable_event_type(device_.get(), EV_KEY);
    libevdev_enable_event_code(device_.get(), EV_KEY, BTN_0, nullptr);
    libevdev_enable_event_type(device_.get(), type);
    const input_absinfo travel{
        .value = 0, .minimum = -350, .maximum = 350, .fuzz = 0, .flat = 0, .resolution = 0};
    for (unsigned axis = first; axis <= last; ++axis)
      libevdev_enable_event_code(device_.get(), type, axis, type == EV_ABS ? &travel : nullptr);
  }
  void give(unsigned key) { libevdev_enable_event_code(device_.get(), EV_KEY, key, nullptr); }
  std::optional<EvdevTraits> traits() const { return traits_of(device_.get()); }

 private:
  struct Free {
    void operator()(libevdev* device) const { libevdev_free(device); }
  };
  std::unique_ptr<libevdev, Free> device_{libevdev_new()};
};

TEST(SpaceMouseTraits, AreSixAxesOfItsMakers) {
  const auto absolute = Shown(0x256f, EV_ABS, ABS_X, ABS_RZ).traits();
  ASSERT_TRUE(absolute);
  EXPECT_EQ(absolute->kind, EvdevTraits::Kind::kSpaceMouse);
  EXPECT_FALSE(absolute->relative);
  const auto relative = Shown(0x046d, EV_REL, REL_X, REL_RZ).traits();
  ASSERT_TRUE(relative);
  EXPECT_EQ(relative->kind, EvdevTraits::Kind::kSpaceMouse);
  EXPECT_TRUE(relative->relative);
  EXPECT_FALSE(Shown(0x1234, EV_ABS, ABS_X, ABS_RZ).traits()) << "somebody else's joystick";
  EXPECT_FALSE(Shown(0x046d, EV_REL, REL_X, REL_Y).traits()) << "a mouse";
  Shown pad(0x046d, EV_ABS, ABS_X, ABS_RZ);
  pad.give(BTN_SOUTH);
  pad.give(BTN_TL);
  EXPECT_EQ(pad.traits()->kind, EvdevTraits::Kind::kGamepad);
}

TEST(SpaceMouseTraits, WhereThereIsNoneItIsSaidInASentence) {
  const auto refusal = [](const std::string& rest) -> std::string {
    try {
      (void)open_space_mouse(rest, {});
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("/dev/input/none").find("No such file or directory"), std::string::npos);
  EXPECT_NE(refusal("/dev/null").find("no event device"), std::string::npos);
  if (event_devices().empty()) {
    EXPECT_NE(refusal("").find("hand = spacemouse: no SpaceMouse is among"), std::string::npos);
  }
}

}  // namespace
}  // namespace telekerf::master
