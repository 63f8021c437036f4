// SPDX-License-Identifier: Apache-2.0
// Gamepad, pen and pedal by the events that they send, without a device.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/runtime/startup_error.h"
#include "master/operator/evdev_device.h"
#include "master/operator/evdev_state.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class Device {
 public:
  explicit Device(EvdevTraits traits) : state(traits) {}
  void key(int code, int value) { state.hear(EV_KEY, code, value); }
  void axis(int code, int value) { state.hear(EV_ABS, code, value); }
  OperatorSample step(int steps = 1) {
    OperatorSample sample;
    for (int n = 0; n < steps; ++n) sample = state.sample(now_ns += kMs);
    return sample;
  }
  void tool_at(double x_m, double y_m) {
    state.answer({.now_ns = now_ns, .guided = true, .tool_m = Vec2(x_m, y_m)});
  }

  EvdevState state;
  std::int64_t now_ns = 1000 * kMs;
};

EvdevTraits pedal() { return {}; }
EvdevTraits pad() {
  return {.kind = EvdevTraits::Kind::kGamepad,
          .x = {-32768, 32767, 0},
          .y = {-32768, 32767, 0},
          .trigger = EvdevAxis{0, 255, 0}};
}
EvdevTraits pen() {
  return {.kind = EvdevTraits::Kind::kPen, .x = {0, 20000, 100}, .y = {0, 15000, 100}, .trigger = {}};
}

TEST(Evdev, APedalFiresWhileItIsDownAndLeadsNothing) {
  Device device(pedal());
  EXPECT_FALSE(device.step().trigger);
  device.key(KEY_F14, 1);
  const OperatorSample down = device.step();
  EXPECT_TRUE(down.trigger);
  EXPECT_FALSE(down.held);
  EXPECT_FALSE(down.pointer_m);
  device.key(KEY_F14, 2);  // the kernel repeats
  EXPECT_TRUE(device.step().trigger);
  device.key(KEY_F14, 0);
  EXPECT_FALSE(device.step().trigger);
  device.key(KEY_F14, 2);
  EXPECT_FALSE(device.step().trigger) << "a repetition is no press";
}

TEST(Evdev, WhatWasDownAtTheBeginningCountsOnlyAfterItWasUp) {
  Device device(pedal());
  device.key(KEY_F14, 1);
  EXPECT_FALSE(device.step(100).trigger);
  device.key(KEY_F14, 0);
  device.step();
  device.key(KEY_F14, 1);
  EXPECT_TRUE(device.step().trigger);
}

TEST(Evdev, LostEventsLetGo) {
  Device device(pedal());
  device.step();
  device.key(KEY_F14, 1);
  ASSERT_TRUE(device.step().trigger);
  device.state.hear(EV_SYN, SYN_DROPPED, 0);
  EXPECT_FALSE(device.step(100).trigger);
  device.key(KEY_F14, 0);
  device.step();
  device.key(KEY_F14, 1);
  EXPECT_TRUE(device.step().trigger);
}

TEST(Evdev, AKeyThatTheKernelDoesNotSeeIsUp) {
  Device device(pedal());
  device.step();
  device.key(KEY_F14, 1);
  device.state.confirm(true);
  EXPECT_TRUE(device.step().trigger);
  device.state.confirm(false);
  EXPECT_FALSE(device.step().trigger);
}

TEST(Evdev, APadsStickLeadsWhileAShoulderHolds) {
  Device device(pad());
  device.tool_at(0.01, 0.02);
  device.axis(ABS_X, 32767);
  EXPECT_FALSE(device.step().held) << "a stick alone holds nothing";
  device.key(BTN_TL, 1);
  OperatorSample sample = device.step();
  ASSERT_TRUE(sample.held && sample.pointer_m);
  EXPECT_NEAR(sample.pointer_m->x(), 0.01 + 0.04e-3, 1e-9);
  sample = device.step(99);
  EXPECT_NEAR(sample.pointer_m->x(), 0.01 + 100 * 0.04e-3, 1e-8) << "40 mm/s";
  EXPECT_NEAR(sample.pointer_m->y(), 0.02, 1e-7);
  sample = device.step(1000);
  EXPECT_NEAR(sample.pointer_m->x(), 0.01 + 0.012, 1e-8) << "no farther from the tool than the arm feels";
  device.axis(ABS_X, 0);
  device.axis(ABS_Y, -32768);
  const double y_m = device.step().pointer_m->y();
  EXPECT_GT(device.step(50).pointer_m->y(), y_m) << "the kernel counts y downwards";
  device.key(BTN_TL, 0);
  EXPECT_FALSE(device.step().held);
  device.tool_at(0.05, 0.0);
  device.axis(ABS_Y, 0);
  device.key(BTN_TL, 1);
  EXPECT_NEAR(device.step().pointer_m->x(), 0.05, 1e-9) << "a new hold begins at the tool";
}

TEST(Evdev, AStickAtRestLeadsNowhereThoughItIsNotInItsMiddle) {
  Device device(pad());
  device.step();
  device.axis(ABS_X, 3500);
  device.key(BTN_TR, 1);
  EXPECT_EQ(device.step(500).pointer_m->x(), 0.0);
}

TEST(Evdev, APadsTriggerFiresOnlyWhileItHolds) {
  Device device(pad());
  device.step();
  device.axis(ABS_RZ, 255);
  EXPECT_FALSE(device.step().trigger);
  device.axis(ABS_RZ, 0);
  device.key(BTN_TR, 1);
  EXPECT_FALSE(device.step().trigger);
  device.axis(ABS_RZ, 120);
  EXPECT_FALSE(device.step().trigger);
  device.axis(ABS_RZ, 140);
  EXPECT_TRUE(device.step().trigger);
  device.axis(ABS_RZ, 0);
  device.key(BTN_TR2, 1);
  EXPECT_TRUE(device.step().trigger);
  device.key(BTN_TR, 0);
  EXPECT_FALSE(device.step().trigger);
}

TEST(Evdev, APenLeadsInTrueSizeFromWhereItTouched) {
  Device device(pen());
  device.tool_at(0.01, 0.0);
  device.axis(ABS_X, 5000);
  device.axis(ABS_Y, 5000);
  EXPECT_FALSE(device.step().held) << "hovering";
  device.key(BTN_TOUCH, 1);
  EXPECT_NEAR(device.step().pointer_m->x(), 0.01, 1e-12);
  device.axis(ABS_X, 5500);
  device.axis(ABS_Y, 4800);
  const OperatorSample sample = device.step();
  EXPECT_NEAR(sample.pointer_m->x(), 0.01 + 5e-3, 1e-9);
  EXPECT_NEAR(sample.pointer_m->y(), 2e-3, 1e-9);
  EXPECT_FALSE(sample.trigger);
  device.key(BTN_STYLUS, 1);
  EXPECT_TRUE(device.step().trigger);
}

TEST(Evdev, ATabletThatDoesNotSayItsSizeIsTenCentimetresWide) {
  Device device({.kind = EvdevTraits::Kind::kPen, .x = {0, 1000, 0}, .y = {0, 1000, 0}, .trigger = {}});
  device.step();
  device.key(BTN_TOUCH, 1);
  device.step();
  device.axis(ABS_X, 500);
  EXPECT_NEAR(device.step().pointer_m->x(), 0.05, 1e-9);
}

TEST(Evdev, WhatIsNoInputDeviceIsRefusedWithASentence) {
  const auto refusal = [](const std::string& path) -> std::string {
    try {
      EvdevDevice device(path);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("/dev/input/none"),
            "input device /dev/input/none: No such file or directory; telekerf-inspect inputs lists those "
            "that are there");
  EXPECT_NE(refusal("/dev/null").find("input device /dev/null: no event device"), std::string::npos);
  EXPECT_THROW((void)open_evdev_hand("/dev/null", {}), StartupError);
  EXPECT_THROW((void)open_evdev_button("/dev/null"), StartupError);
}

TEST(Evdev, DevicesAreListedByTheirNumbers) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("telekerf_inputs_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const char* const name : {"event10", "event9", "mouse0", "event", "eventx", "event1b"})
    std::ofstream(folder / name) << "";
  EXPECT_EQ(event_devices(folder.string()),
            (std::vector<std::string>{(folder / "event9").string(), (folder / "event10").string()}));
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(event_devices(folder.string()).empty());
}

}  // namespace
}  // namespace telekerf::master
