// SPDX-License-Identifier: Apache-2.0
#include "common/robot/drivers/drives.h"

#include <string_view>
#include <utility>

#include "common/robot/drivers/udp_robot.h"
#include "common/runtime/device_registry.h"
#include "common/runtime/udp.h"

namespace telekerf::robot {
namespace {

Drive simulated(std::string_view, const RobotModel& nominal, double, const Simulation& simulation) {
  RobotModel truth = mismatched(nominal, simulation.mismatch, simulation.seed);
  truth.sensor.kind = simulation.sensor.value_or(truth.sensor.kind);
  auto robot = std::make_unique<SimulatedRobot>(truth, simulation.seed, nominal.in_base(Vec3::Zero()));
  SimulatedRobot* const plant = robot.get();
  return {std::move(robot), plant};
}

Drive udp(std::string_view rest, const RobotModel&, double control_hz, const Simulation&) {
  return {std::make_unique<UdpRobot>(udp_address(rest), 1.0 / control_hz)};
}

using Table = DeviceRegistry<Drive, const RobotModel&, double, const Simulation&>;
constexpr Table::Kind kKinds[] = {
    {"simulated", "simulated", stands_alone, simulated},
    {"udp", "udp:HOST:PORT", complaint_about_udp, udp},
};
constexpr Table kDrives("drive", kKinds);

}  // namespace

std::string drive_forms() { return kDrives.forms(); }

std::string complaint_about_drive(const std::string& drive) { return kDrives.complaint(drive); }

Drive attach(const std::string& drive, const RobotModel& nominal, double control_hz,
             const Simulation& simulation) {
  return kDrives.attach(drive, nominal, control_hz, simulation);
}

}  // namespace telekerf::robot
