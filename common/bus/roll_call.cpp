// SPDX-License-Identifier: Apache-2.0
#include "common/bus/roll_call.h"

#include <algorithm>
#include <chrono>
#include <tuple>

namespace telekerf {
namespace {

constexpr const char* kRole = "clock";
constexpr const char* kAsker = "ctl";  ///< role of telekerf-ctl

double wall_clock_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

void ClockTeller::tell() {
  if (writer_.readers() == 0) return;
  // Consoles and recorders listen to telemetry all the time, and never ask.
  const auto others = bus_.others();
  if (std::none_of(others.begin(), others.end(), [](const auto& other) { return other.role == kAsker; })) return;
  writer_.write({.role = kRole, .tick = epoch_, .values = {{"wall_clock_s", wall_clock_s()}}});
}

RollCall::RollCall(Bus& bus)
    : bus_(bus), reader_(bus, [this](const TelemetryMessage& message) { hear(message); }) {}

void RollCall::hear(const TelemetryMessage& message) {
  if (message.role != kRole || message.values.size() != 1) return;
  const double ahead_s = message.values.front().second - wall_clock_s();
  const std::lock_guard lock(mutex_);
  // The one that was on its way for the shortest time is the best.
  const auto known = ahead_s_.try_emplace(static_cast<std::uint32_t>(message.tick), ahead_s).first;
  known->second = std::max(known->second, ahead_s);
}

std::vector<RollCall::Present> RollCall::present() const {
  std::vector<Present> all;
  const std::lock_guard lock(mutex_);
  for (const Bus::Seen& seen : bus_.seen()) {
    Present one{seen.presence, seen.address, std::nullopt};
    if (const auto said = ahead_s_.find(seen.presence.epoch); said != ahead_s_.end())
      one.clock_ahead_s = said->second;
    all.push_back(std::move(one));
  }
  std::sort(all.begin(), all.end(), [](const Present& a, const Present& b) {
    return std::tie(a.who.role, a.who.name) < std::tie(b.who.role, b.who.name);
  });
  return all;
}

}  // namespace telekerf
