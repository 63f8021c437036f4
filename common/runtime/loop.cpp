// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/loop.h"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <memory>

#include "common/runtime/clock.h"
#include "common/runtime/real_time.h"

namespace telekerf {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_signal(int) { stop.store(true); }

}  // namespace

void DurationHistogram::add(std::int64_t duration_ns) noexcept {
  const std::int64_t bin =
      std::clamp<std::int64_t>(duration_ns / kBinNs, 0, static_cast<std::int64_t>(bins_.size()) - 1);
  ++bins_[static_cast<std::size_t>(bin)];
  ++count_;
  min_ns_ = std::min(min_ns_, duration_ns);
  max_ns_ = std::max(max_ns_, duration_ns);
}

double DurationHistogram::quantile_us(double share) const noexcept {
  if (count_ == 0) return 0.0;
  const auto rank =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen >= rank) return static_cast<double>((static_cast<std::int64_t>(bin) + 1) * kBinNs) * 1e-3;
  }
  return max_us();
}

LoopStatistics run_loop(double rate_hz, const std::function<bool(std::int64_t)>& step) {
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 / rate_hz));
  LoopStatistics statistics;
  const auto slack = std::make_unique<DurationHistogram>();
  const auto late = std::make_unique<DurationHistogram>();
  mlockall(MCL_CURRENT | MCL_FUTURE);  // granted or not, as the priority
  const RealTimePriority priority(kLoopPriority);
  statistics.real_time = priority.granted();
  const std::int64_t start_ns = monotonic_ns();
  std::int64_t deadline_ns = start_ns;
  for (;;) {
    std::int64_t now_ns = monotonic_ns();
    while (now_ns < deadline_ns) {  // a signal may wake it early
      sleep_until_ns(deadline_ns);
      now_ns = monotonic_ns();
    }
    late->add(now_ns - deadline_ns);
    ++statistics.steps;
    if (!step(now_ns)) break;
    deadline_ns += period_ns;
    const std::int64_t left_ns = deadline_ns - monotonic_ns();
    slack->add(left_ns);
    if (left_ns < 0) {
      ++statistics.overruns;
      deadline_ns = monotonic_ns() + period_ns;
    }
  }
  const double elapsed_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
  statistics.rate_hz = elapsed_s > 0.0 ? static_cast<double>(statistics.steps) / elapsed_s : 0.0;
  statistics.slack_p50_us = slack->quantile_us(0.5);
  statistics.slack_p99_us = slack->quantile_us(0.01);
  statistics.slack_min_us = slack->min_us();
  statistics.late_p50_us = late->quantile_us(0.5);
  statistics.late_p99_us = late->quantile_us(0.99);
  statistics.late_max_us = late->max_us();
  return statistics;
}

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A terminal that closes ends a robot in order; under nohup it does not.
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  // Who reads what we say may go: that is no reason to go, too.
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
}

bool stop_requested() noexcept { return stop.load(std::memory_order_relaxed); }
void request_stop() noexcept { stop.store(true); }

}  // namespace telekerf
