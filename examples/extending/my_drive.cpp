// SPDX-License-Identifier: Apache-2.0
// The drive of docs/how-to/add-a-drive.md, section 4: known by its name, refused where its name is wrong, and
// watched like any other.
#include <fmt/format.h>

#include "common/robot/drivers/drives.h"
#include "common/robot/supervisor.h"

int main() {
  using namespace telekerf::robot;
  const RobotModel model = load_robot("slave-keops");
  fmt::print("drives: {}\n", drive_forms());
  fmt::print("mine:far is refused: {}\n", validate_drive("mine:far"));

  RobotSupervisorSettings settings;
  settings.drive = "mine:0.0181";
  RobotSupervisor robot(model, settings, 1000.0, open_drive(settings.drive, {model, 1000.0, {}}));
  const auto reading = robot.read();
  robot.write({0.1, 0.1, 0.1});
  fmt::print("{}: joint 1 at {} m\n", settings.drive, reading.joints_m.x());
  const bool good = !validate_drive("mine:far").empty() && validate_drive("mine:0.01").empty() &&
                    reading.valid && reading.joints_m.x() == 0.0181 && robot.plant() == nullptr;
  return good ? 0 : 1;
}
