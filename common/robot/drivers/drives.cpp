// SPDX-License-Identifier: Apache-2.0
#include "common/robot/drivers/drives.h"

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/drivers/udp_robot.h"

namespace telekerf::robot {
namespace {

// A drive of your own: its header above, and one row.
constexpr DriveKind kKinds[] = {
    kSimulatedDrive,
    kUdpDrive,
};
constexpr DriveRegistry kDrives("drive", kKinds);

}  // namespace

std::string drive_forms() { return kDrives.forms(); }

std::string validate_drive(const std::string& drive) { return kDrives.validate(drive); }

Drive open_drive(const std::string& drive, const DriveNeeds& needs) { return kDrives.open(drive, needs); }

}  // namespace telekerf::robot
