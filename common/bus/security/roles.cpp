// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/roles.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/bus/security/openssl.h"

namespace telekerf::security {
namespace {

constexpr const char* kCommand = "telekerf/command";
constexpr const char* kState = "telekerf/state";
constexpr const char* kContour = "telekerf/contour";
constexpr const char* kPreview = "telekerf/preview";
constexpr const char* kEvent = "telekerf/event";
constexpr const char* kStop = "telekerf/stop";
constexpr const char* kTelemetry = "telekerf/telemetry";
constexpr const char* kPeer = "peer";
constexpr std::size_t kMaxName = 64;

}  // namespace

std::span<const Role> roles() {
  static const std::vector<Role> all = {
      {"master",
       Site::kOperator,
       {kPresenceTopic, kCommand, kEvent, kStop, kTelemetry},
       {kState, kContour, kEvent, kStop, kTelemetry}},
      {"slave",
       Site::kSlave,
       {kPresenceTopic, kState, kEvent, kStop, kTelemetry},
       {kCommand, kContour, kEvent, kStop, kTelemetry}},
      {"vision", Site::kSlave, {kPresenceTopic, kContour, kPreview, kEvent, kTelemetry}, {kEvent, kStop}},
      {"console",
       Site::kOperator,
       {kPresenceTopic, kEvent, kStop, kTelemetry},
       {kCommand, kState, kContour, kPreview, kEvent, kStop, kTelemetry}},
      {"ctl", Site::kOperator, {kPresenceTopic, kEvent, kStop}, {kEvent, kStop, kTelemetry}},
      {"plant", Site::kSlave, {kPresenceTopic, kTelemetry}, {kContour, kEvent}},
      {"recorder", Site::kOperator, {kPresenceTopic}, {kState, kContour, kTelemetry}},
      {kPeer, Site::kOperator, {}, {kState, kContour, kTelemetry}},
  };
  return all;
}

const Role* find_role(const std::string& name) {
  const auto all = roles();
  const auto role = std::find_if(all.begin(), all.end(), [&](const Role& each) { return name == each.name; });
  return role == all.end() ? nullptr : &*role;
}

std::string complaint_about_secured_cell(const std::string& cell) {
  if (cell.empty() || cell.size() > kMaxName) return "must have 1 to 64 letters";
  const bool plain = std::all_of(cell.begin(), cell.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '_' || letter == '.';
  });
  if (!plain || cell.front() == '.')
    return "must consist of letters, digits, '-', '_' and '.', and not begin with '.'";
  return "";
}

std::string common_name(const std::string& cell, const std::string& role) {
  if (role != kPeer) return role;
  SubjectPrefix lowest;
  lowest.fill(0xff);
  for (const Role& each : roles()) {
    if (each.name != std::string(kPeer)) lowest = std::min(lowest, prefix_of(cell, each.name));
  }
  for (int number = 1;; ++number) {
    std::string name = fmt::format("{}-{}", kPeer, number);
    if (prefix_of(cell, name) < lowest) return name;
  }
}

std::string subject_of(const std::string& cell, const std::string& common_name) {
  return fmt::format("CN={},OU={},O=Telekerf", common_name, cell);
}

SubjectPrefix prefix_of(const std::string& cell, const std::string& common_name) {
  return prefix_of(subject_name(cell, common_name).get());
}

}  // namespace telekerf::security
