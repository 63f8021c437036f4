// SPDX-License-Identifier: Apache-2.0
// The control path allocates nothing: both stations' steps, streaming, guided and engaged.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/drivers/udp_robot.h"
#include "experiments/simulation/simulation.h"
#include "tests/unit/allocations.h"
#include "tests/unit/laser/laser_device.h"

namespace telekerf::simulation {
namespace {

TEST(ControlPath, NeitherStationsStepAllocates) {
  SimulationSettings settings;
  settings.master.hand_speed_mm_s = 30.0;
  const ContourMessage contour = find_contour(settings);
  master::Station master(settings.master);
  slave::Station slave(settings.slave);
  const auto task = master.prepare(contour);
  const auto corridor = slave.prepare(contour);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  commands.reserve(4);
  states.reserve(4);

  std::uint64_t in_steps = 0;
  for (int n = 0; n < 8000; ++n) {
    const std::int64_t now_ns = n * std::int64_t{1'000'000};
    const auto before = ::telekerf::testing::allocations();
    const auto command = master.step(now_ns, task.get(), states, {});
    states.clear();
    if (command.command) commands.push_back({*command.command, now_ns});
    const auto state = slave.step(now_ns, corridor.get(), commands, {});
    commands.clear();
    if (state.state) states.push_back({*state.state, now_ns});
    in_steps += ::telekerf::testing::allocations() - before;
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_GT(testing::allocations(), 0u) << "the counter counts";
#endif
  EXPECT_EQ(in_steps, 0u);
}

TEST(ControlPath, NorDoesOneWithRobotAndLaserInAnotherProcess) {
  slave::StationSettings settings;
  const robot::RobotModel model = robot::load_robot(settings.robot);
  robot::SimulatedRobot plant(model, 1, model.in_base(Vec3::Zero()));
  robot::UdpDrive drive(plant, 0);
  settings.machine.drive = "udp:127.0.0.1:" + std::to_string(drive.port());
  laser::LaserSocket laser;
  settings.beam.laser = laser.laser();
  settings.beam.laser_max_w = 20.0;
  std::jthread answering([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) drive.serve_for(0.01);
  });
  slave::Station slave(settings);  // waits for the drive's first answer
  answering.request_stop();
  answering.join();

  std::uint64_t in_steps = 0;
  for (int n = 0; n < 2000; ++n) {
    const auto before = ::telekerf::testing::allocations();
    (void)slave.step(n * std::int64_t{1'000'000}, nullptr, {}, {});
    in_steps += ::telekerf::testing::allocations() - before;
    for (int i = 0; i < 1000 && drive.serve_for(0.0) == 0; ++i) std::this_thread::yield();
  }
  EXPECT_TRUE(slave.machine().started());
  EXPECT_FALSE(slave.machine().failed());
  EXPECT_EQ(in_steps, 0u);
  RunRecord record;
  slave.report(record);
  EXPECT_EQ(record.slave_figures.at("laser_untold"), 0.0);
  EXPECT_TRUE(laser.take().has_value());
}

}  // namespace
}  // namespace telekerf::simulation
