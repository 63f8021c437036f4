// SPDX-License-Identifier: Apache-2.0
#include "common/robot/drives.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "common/robot/udp_robot.h"
#include "common/runtime/refusal.h"

namespace telekerf::robot {
namespace {

/// One way to reach a robot: what stands before the first colon of a `drive`. `rest` is what stands after it.
struct Kind {
  std::string_view name;
  std::string_view form;  ///< as a user writes it
  /// What the drive must be, if it is not; empty: it is.
  std::string (*complaint)(std::string_view rest);
  Drive (*attach)(std::string_view rest, const RobotModel& nominal, double control_hz,
                  const Simulation& simulation);
};

Drive simulated(std::string_view, const RobotModel& nominal, double, const Simulation& simulation) {
  RobotModel truth = mismatched(nominal, simulation.mismatch, simulation.seed);
  truth.sensor.kind = simulation.sensor.value_or(truth.sensor.kind);
  auto robot = std::make_unique<SimulatedRobot>(truth, simulation.seed, nominal.in_base(Vec3::Zero()));
  SimulatedRobot* const plant = robot.get();
  return {std::move(robot), plant};
}

struct Address {
  std::string host;
  std::uint16_t port = 0;  ///< 0: none was given, or none that there is
};

Address address_of(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == text.npos) return {std::string(text)};
  Address address{std::string(text.substr(0, colon))};
  const std::string_view digits = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), address.port);
  if (error != std::errc() || end != digits.end()) address.port = 0;
  return address;
}

std::string udp_complaint(std::string_view rest) {
  const Address address = address_of(rest);
  if (!address.host.empty() && address.port != 0) return "";
  return "udp needs a host and a port within [1, 65535], as in udp:127.0.0.1:7000";
}

Drive udp(std::string_view rest, const RobotModel&, double control_hz, const Simulation&) {
  const Address address = address_of(rest);
  return {std::make_unique<UdpRobot>(address.host, address.port, 1.0 / control_hz)};
}

constexpr std::array kKinds{
    Kind{"simulated", "simulated",
         [](std::string_view rest) -> std::string { return rest.empty() ? "" : "simulated stands alone"; },
         simulated},
    Kind{"udp", "udp:HOST:PORT", udp_complaint, udp},
};

const Kind* kind_of(std::string_view drive) {
  for (const Kind& kind : kKinds) {
    if (drive.substr(0, drive.find(':')) == kind.name) return &kind;
  }
  return nullptr;
}

std::string_view rest_of(std::string_view drive) {
  const std::size_t colon = drive.find(':');
  return colon == drive.npos ? std::string_view() : drive.substr(colon + 1);
}

}  // namespace

std::string drive_forms() {
  std::string forms;
  for (const Kind& kind : kKinds) forms += fmt::format("{}{}", forms.empty() ? "" : ", ", kind.form);
  return forms;
}

std::string complaint_about_drive(const std::string& drive) {
  if (const Kind* kind = kind_of(drive)) return kind->complaint(rest_of(drive));
  return fmt::format("must be one of {}; docs/attach-a-drive.md says how to add a machine", drive_forms());
}

Drive attach(const std::string& drive, const RobotModel& nominal, double control_hz,
             const Simulation& simulation) {
  if (const std::string complaint = complaint_about_drive(drive); !complaint.empty()) {
    throw Refusal(fmt::format("drive = {}: {}", drive, complaint));
  }
  return kind_of(drive)->attach(rest_of(drive), nominal, control_hz, simulation);
}

}  // namespace telekerf::robot
