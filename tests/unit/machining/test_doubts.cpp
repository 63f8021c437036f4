// SPDX-License-Identifier: Apache-2.0
// What keeps the beam of automatic machining off, beside the tool's place: the devices, the clock, the dose.
#include <gtest/gtest.h>

#include <array>

#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/machining/work.h"

namespace telekerf::machining {
namespace {

TEST(MachiningStation, MoreThanAPlaceMayHaveInOnePassIsRefused) {
  StationSettings settings = quick();
  settings.speed_mm_s = 1.0;
  EXPECT_EQ(
      refusal_of([&] { settings.validate(); }),
      "laser_w = 10 at speed_mm_s = 1 gives a place 2.7 J in one pass, more than dose_max_j = 2; lower the "
      "power, or raise dose_max_j if the material bears it");
  settings.interlock.max_dose_j = 3.0;
  EXPECT_EQ(refusal_of([&] { settings.validate(); }), "accepted");
}

TEST_F(MachiningAtWork, WhatDevicesAndTheClockSayForbidsAtItsVeryStep) {
  const robot::RobotModel model = robot::load_robot("slave-keops");
  robot::SimulatedRobot plant(model, 1, model.in_base(Vec3::Zero()));
  JobExecutor executor(model, *job_, {});
  executor.reset(plant.read().joints_m);
  constexpr DeviceState kDoubts[] = {
      {}, {.fault = true}, {.on_time = false}, {.emission_agrees = false}, {.monitor_agrees = false}};
  constexpr std::uint32_t kBits[] = {0, laser::guard_bit("fault"), laser::guard_bit("on-time"),
                                     laser::guard_bit("emission"), laser::guard_bit("monitor")};
  std::array<int, 5> seen{};
  for (std::size_t i = 0; i < job_->trajectory.size(); ++i) {
    const std::size_t doubt = i / 40 % 5;
    const auto out = executor.step(plant.read(), false, kDoubts[doubt]);
    plant.write(out.currents_a);
    plant.advance(job_->period_s);
    constexpr std::uint32_t kDevices = kBits[1] | kBits[2] | kBits[3] | kBits[4];
    ASSERT_EQ(out.forbidden & kDevices, kBits[doubt]) << i;
    if (doubt != 0) {
      ASSERT_EQ(out.laser_w, 0.0) << i;
    }
    if ((out.forbidden & ~kDevices) == 0) ++seen[doubt];
  }
  for (const int n : seen) EXPECT_GT(n, 100) << "nothing else was against it";
}

/// The light that it was on for comes to nothing within the dose: what is beyond is left out.
class DosedAtWork : public MachiningAtWork {
 protected:
  DosedAtWork()
      : MachiningAtWork([] {
          StationSettings settings = quick();
          settings.interlock.max_dose_j = 0.3;
          settings.laser_w = 20.0;
          return settings;
        }()) {}
};

TEST_F(DosedAtWork, NoPlaceGetsMoreThanItMayWhereverThePathComesByAgain) {
  // To and fro over the same millimetres.
  ContourMessage message;
  message.closed = false;
  for (int n = 0; n < 4; ++n) {
    message.points_m.emplace_back(n % 2 == 0 ? -1e-3 : 1e-3, 20e-6 * n);
  }
  job_ = station_.prepare(message);
  laser::DoseBook book(0.03);
  station_.begin(*job_);
  std::uint32_t forbidden = 0;
  while (!station_.ended()) {
    const JobExecutorOutputs out = station_.step(now_ns(), false);
    book.add(out.tool_m.head<2>(), out.laser_w * job_->period_s);
    EXPECT_LE(book.at(out.tool_m.head<2>()).place_j, 0.3 + 1e-6);
    if (out.phase == JobPhase::kCut) forbidden |= out.forbidden;
  }
  EXPECT_NE(forbidden & laser::guard_bit("dose"), 0u);
}

TEST_F(MachiningAtWork, AStepThatComesLateKeepsTheBeamOffForTwentyMilliseconds) {
  station_.begin(*job_);
  std::int64_t late_ns = 0;
  int dark = 0, lit = 0;
  while (!station_.ended()) {
    std::int64_t at_ns = now_ns();
    if (lit == 500 && late_ns == 0) at_ns = late_ns = now_ns_ += 4'000'000;
    const JobExecutorOutputs out = station_.step(at_ns, false);
    lit += out.laser_w > 0.0 ? 1 : 0;
    const bool late = late_ns != 0 && at_ns - late_ns < 20'000'000;
    ASSERT_EQ((out.forbidden & laser::guard_bit("on-time")) != 0, late);
    ASSERT_FALSE(late && out.laser_w > 0.0);
    dark += late ? 1 : 0;
  }
  EXPECT_EQ(dark, 48);
  EXPECT_TRUE(station_.finished());
}

}  // namespace
}  // namespace telekerf::machining
