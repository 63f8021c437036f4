// SPDX-License-Identifier: Apache-2.0
// From what a user names as `drive` to a robot. A drive is its own files, which define a DriveKind beside the
// Robot, and one row in drives.cpp.
#pragma once

#include <string>

#include "common/robot/drivers/drive.h"

namespace telekerf::robot {

/// How a `drive` may be written, one form after the other.
std::string drive_forms();
/// What is wrong with a `drive` as a user wrote it, and the remedy; empty: nothing.
std::string validate_drive(const std::string& drive);
/// Throws StartupError.
Drive open_drive(const std::string& drive, const DriveNeeds& needs);

}  // namespace telekerf::robot
