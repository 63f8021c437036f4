// SPDX-License-Identifier: Apache-2.0
// Who is in a cell, on which computer, with which version, and what that computer's clock shows.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/reader.h"
#include "common/bus/writer.h"

namespace telekerf {

/// Every process' side: says now and then what this computer's clock shows. Nothing is sent while no
/// telekerf-ctl is there to ask.
class ClockTeller {
 public:
  explicit ClockTeller(Bus& bus) : bus_(bus), writer_(bus), epoch_(bus.settings().epoch) {}
  /// Several times a second, from a thread that may wait.
  void tell();

 private:
  Bus& bus_;
  Writer<TelemetryMessage> writer_;
  std::uint32_t epoch_;
};

/// The side of who asks.
class RollCall {
 public:
  /// Listens from now on.
  explicit RollCall(Bus& bus);

  struct Present {
    PresenceMessage who;
    std::string address;  ///< IPv4
    /// How far its clock is ahead of this computer's, less the time that the way here takes; none: it has not
    /// said.
    std::optional<double> clock_ahead_s;
  };
  /// Everyone else in the cell, by role and name.
  std::vector<Present> present() const;

 private:
  void hear(const TelemetryMessage& message);

  Bus& bus_;
  mutable std::mutex mutex_;
  std::map<std::uint32_t, double> ahead_s_;  ///< by the start's number
  Reader<TelemetryMessage> reader_;          ///< last: hears when everything else is there
};

}  // namespace telekerf
