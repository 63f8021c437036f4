// SPDX-License-Identifier: Apache-2.0
// The control loop: a step at absolute deadlines on the monotonic clock.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

namespace telekerf {

/// How much time was left at each deadline, and how often none was.
struct LoopStatistics {
  std::uint64_t steps = 0;
  std::uint64_t overruns = 0;  ///< steps that were still busy at their next deadline
  double rate_hz = 0.0;        ///< measured
  double slack_p50_us = 0.0;   ///< time from a step's end to its next deadline
  double slack_p99_us = 0.0;   ///< 99 % of the steps had at least this much left
  double slack_min_us = 0.0;
  double late_p50_us = 0.0;  ///< from deadline to wake-up
  double late_p99_us = 0.0;
  double late_max_us = 0.0;
  bool real_time = false;  ///< the scheduler granted real-time priority
};

/// Counts durations in fixed memory: bins of 5 us up to 20 ms, beyond that in the last one.
class DurationHistogram {
 public:
  void add(std::int64_t duration_ns) noexcept;
  /// Smallest duration that at least `share` of all do not exceed.
  double quantile_us(double share) const noexcept;
  double min_us() const noexcept { return count_ == 0 ? 0.0 : static_cast<double>(min_ns_) * 1e-3; }
  double max_us() const noexcept { return count_ == 0 ? 0.0 : static_cast<double>(max_ns_) * 1e-3; }

 private:
  static constexpr std::int64_t kBinNs = 5'000;
  std::array<std::uint64_t, 4000> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t min_ns_ = INT64_MAX;
  std::int64_t max_ns_ = INT64_MIN;
};

/// Calls `step(now_ns)` once a period until it returns false. An overrun is counted and the deadlines start
/// anew from there: time that is lost is never caught up in a burst. Asks for real-time priority and works
/// without it.
LoopStatistics run_loop(double rate_hz, const std::function<bool(std::int64_t now_ns)>& step);

/// SIGINT, SIGTERM and a closed terminal set a flag from now on instead of ending the process;
/// a reader of its output that goes away does not end it either.
void catch_stop_signals();
bool stop_requested() noexcept;
/// Sets the same flag from inside.
void request_stop() noexcept;

}  // namespace telekerf
