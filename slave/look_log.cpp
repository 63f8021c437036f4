// SPDX-License-Identifier: Apache-2.0
#include "slave/look_log.h"

#include <cmath>

#include "slave/laser/guards.h"

namespace telekerf::slave {
namespace {

/// They come round after 49 days.
std::uint32_t milliseconds(std::int64_t time_ns) noexcept {
  return static_cast<std::uint32_t>(time_ns / 1'000'000);
}

}  // namespace

void LookLog::hear(const TelemetryMessage& message, std::int64_t now_ns) {
  if (message.role != "vision") return;
  double id = 0.0, age_s = -1.0;
  for (const auto& [name, value] : message.values) {
    if (name == "contour_id") id = value;
    if (name == "look_age_s") age_s = value;
  }
  if (!(id >= 1.0 && id <= 4294967295.0) || !(age_s >= 0.0 && age_s <= 1e6)) return;
  const std::uint32_t seen_ms = milliseconds(now_ns - std::llround(1e9 * age_s));
  seen_.store(static_cast<std::uint64_t>(id) << 32U | seen_ms, std::memory_order_relaxed);
}

double LookLog::age_s(std::uint32_t contour_id, std::int64_t now_ns) const noexcept {
  const std::uint64_t seen = seen_.load(std::memory_order_relaxed);
  if (seen == 0 || seen >> 32U != contour_id) return laser::kAbsent;
  return 1e-3 * (milliseconds(now_ns) - static_cast<std::uint32_t>(seen));
}

}  // namespace telekerf::slave
