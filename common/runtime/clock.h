// SPDX-License-Identifier: Apache-2.0
// This machine's monotonic clock, as every stamp in the project uses it.
#pragma once

#include <time.h>

#include <cstdint>

namespace telekerf {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// CLOCK_MONOTONIC, ns; meaningless on any other machine.
inline std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

/// Sleeps until `deadline_ns` of that clock; returns early if a signal comes.
inline void sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec deadline{.tv_sec = deadline_ns / kNanosecondsPerSecond,
                          .tv_nsec = deadline_ns % kNanosecondsPerSecond};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

/// The deadline after `last_ns`, a period later; one that has passed by now is left out, so that time that is
/// lost is never caught up in a burst.
inline constexpr std::int64_t next_deadline_ns(std::int64_t last_ns, std::int64_t period_ns,
                                               std::int64_t now_ns) noexcept {
  return last_ns + period_ns > now_ns ? last_ns + period_ns : now_ns;
}

}  // namespace telekerf
