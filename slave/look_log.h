// SPDX-License-Identifier: Apache-2.0
// When vision last saw the contour in force where it is, as it tells once a second.
#pragma once

#include <atomic>
#include <cstdint>

#include "common/protocol/events.h"

namespace telekerf::slave {

class LookLog {
 public:
  /// In the thread that hears: "contour_id" and "look_age_s" of vision's telemetry; other telemetry is
  /// nothing.
  void hear(const TelemetryMessage& message, std::int64_t now_ns);
  /// For the control loop, wait-free: since this contour was last seen, s; not finite: it was not.
  double age_s(std::uint32_t contour_id, std::int64_t now_ns) const noexcept;

 private:
  std::atomic<std::uint64_t> seen_{0};  ///< id and, below it, 32 bits of the time in ms; 0: never
};

}  // namespace telekerf::slave
