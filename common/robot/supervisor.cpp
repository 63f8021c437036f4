// SPDX-License-Identifier: Apache-2.0
#include "common/robot/supervisor.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

/// For the first reading.
constexpr std::chrono::seconds kPatience{5};
/// Without a reading for so long no current is sent, however patient drive_stale_s is: nobody sees what it does.
constexpr double kBlind_s = 0.05;

}  // namespace

void RobotSupervisorSettings::add_parameters(Settings& settings) {
  settings.add("drive", drive, device_form(drive_forms(), validate_drive), "what moves the robot");
  settings.add("drive_stale_s", drive_stale_s, {.min = 0.002, .max = 10, .unit = "s"},
               "no reading of the drive for this long: laser off, currents zero, end");
}

RobotSupervisor::RobotSupervisor(const RobotModel& nominal, const RobotSupervisorSettings& settings,
                                 double control_hz, Drive drive, Pushed pushed)
    : settings_(settings),
      nominal_(nominal),
      period_s_(1.0 / control_hz),
      patience_(static_cast<std::uint64_t>(std::ceil(settings.drive_stale_s * control_hz - 1e-6))),
      drive_(std::move(drive)),
      runaway_(nominal, period_s_, pushed) {
  if (drive_.plant != nullptr) return;  // it is there, and its readings are counted
  const double most_hz = drive_.robot->capabilities().max_rate_hz;
  if (control_hz > most_hz) {
    throw hardware_error(
        fmt::format("drive = {}: takes at most {:g} steps a second, the controller makes {:g}; "
                    "lower its rate",
                    settings_.drive, most_hz, control_hz));
  }
  (void)wait_until_ready();
}

JointReading RobotSupervisor::newest() noexcept {
  JointReading reading = drive_.robot->read();
  reading.valid = reading.valid && reading.tick != newest_tick_;
  if (reading.valid) newest_tick_ = reading.tick;
  return reading;
}

RobotSupervisor::InitialPose RobotSupervisor::wait_until_ready() {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  JointReading reading = newest();
  while (!reading.valid) {
    if (std::chrono::steady_clock::now() > until) {
      throw hardware_error(
          fmt::format("drive = {}: no reading for {} s; is it switched on, homed and connected, and does it answer within 10 ms?",
                      settings_.drive, kPatience.count()));
    }
    drive_.robot->write(Vec3::Zero());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    reading = newest();
  }
  if (!reading.joints_m.allFinite()) {
    runaway_.read(reading, 1);
    throw hardware_error(failure());
  }
  const auto tool_m = DeltaKinematics(nominal_.geometry).forward(reading.joints_m);
  if (!tool_m) {
    throw hardware_error(
        fmt::format("drive = {}: the robot stands where {} has no pose: {}; move it into its workspace, or "
                    "correct its file",
                    settings_.drive, nominal_.name, describe(tool_m.error())));
  }
  return {reading.joints_m, nominal_.in_workpiece(*tool_m)};
}

JointReading RobotSupervisor::read() noexcept {
  JointReading reading = newest();
  reading.valid = reading.valid && !failed();
  if (reading.valid) {
    runaway_.read(reading, missing_ + 1);
    missing_ = 0;
    reading.valid = !failed();
    started_ = started_ || reading.valid;
  } else if (!failed()) {
    ++missing_;
    ++missed_;
  }
  return reading;
}

void RobotSupervisor::write(const Vec3& currents_a) noexcept {
  if (started_ && !failed()) runaway_.written(currents_a);
  const bool blind = static_cast<double>(missing_) * period_s_ >= kBlind_s;
  drive_.robot->write(started_ && !failed() && !blind ? currents_a : Vec3(Vec3::Zero()));
}

void RobotSupervisor::advance() noexcept {
  if (drive_.plant != nullptr) drive_.plant->advance(period_s_);
}

std::string RobotSupervisor::failure() const {
  if (runaway_.tripped()) {
    return fmt::format("drive = {}: the laser is off and the currents are zero, because {}", settings_.drive,
                       runaway_.sentence());
  }
  if (drive_.plant != nullptr) {
    return fmt::format(
        "drive = {}: the robot left the poses that it can take, so the laser is off and the currents "
        "are zero; is the work too large for it, or a bandwidth too high?",
        settings_.drive);
  }
  return fmt::format(
      "drive = {}: no reading for {:g} s (drive_stale_s), so the laser is off and the currents are zero; "
      "is the drive still running and connected, and does it answer within 10 ms?",
      settings_.drive, settings_.drive_stale_s);
}

std::optional<Vec3> RobotSupervisor::true_tool_m() const noexcept {
  if (drive_.plant == nullptr) return std::nullopt;
  return nominal_.in_workpiece(drive_.plant->true_tool_in_base_m());
}

std::optional<Vec3> RobotSupervisor::true_tool_velocity_m_per_s() const noexcept {
  if (drive_.plant == nullptr) return std::nullopt;
  return drive_.plant->true_tool_velocity_m_per_s();
}

}  // namespace telekerf::robot
