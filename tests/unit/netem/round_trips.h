// SPDX-License-Identifier: Apache-2.0
// Pings through a profile in virtual time, as studies measure networks, and their statistics.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "netem/core/emulator.h"

namespace telekerf::netem {

struct Ping {
  double sent_s = 0.0;
  double forward_ms = -1.0;     ///< -1: lost on the way there
  double round_trip_ms = -1.0;  ///< -1: lost on the way there or back
};

/// One ping after the other, `rate_hz` of them a second.
inline std::vector<Ping> ping(const Profile& profile, double rate_hz, double duration_s, std::uint64_t seed) {
  Emulator there(profile.forward, {seed, 0, Direction::kForward}, {1U << 16, 0, 0});
  Emulator back(profile.backward, {seed, 0, Direction::kBackward}, {1U << 16, 0, 0});
  std::vector<Ping> pings;
  for (std::int64_t i = 0; static_cast<double>(i) < duration_s * rate_hz; ++i) {
    const auto now_ns = static_cast<std::int64_t>(static_cast<double>(i) * 1e9 / rate_hz);
    while (there.pop(now_ns)) {
    }
    while (back.pop(now_ns)) {
    }
    pings.push_back({static_cast<double>(now_ns) * 1e-9});
    const PacketOutcome on_way = there.push(now_ns, 200U, 0);
    if (on_way.lost()) continue;
    pings.back().forward_ms = static_cast<double>(on_way.due_ns - now_ns) * 1e-6;
    const PacketOutcome answer = back.push(on_way.due_ns, 200U, 0);
    if (!answer.lost()) pings.back().round_trip_ms = static_cast<double>(answer.due_ns - now_ns) * 1e-6;
  }
  return pings;
}

inline double quantile(std::vector<double> values, double p) {
  const std::size_t at =
      std::min(values.size() - 1, static_cast<std::size_t>(p * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

inline std::vector<double> round_trips_ms(const std::vector<Ping>& pings) {
  std::vector<double> values;
  for (const Ping& p : pings) {
    if (p.round_trip_ms >= 0) values.push_back(p.round_trip_ms);
  }
  return values;
}

/// Medians of windows of this length, the first of which ends at `end_s`.
inline std::vector<double> window_medians_ms(const std::vector<Ping>& pings, double window_s, double end_s) {
  std::vector<double> medians, window;
  for (const Ping& p : pings) {
    if (p.sent_s >= end_s) {
      if (!window.empty()) medians.push_back(quantile(window, 0.5));
      window.clear();
      end_s += window_s;
    }
    if (p.round_trip_ms >= 0) window.push_back(p.round_trip_ms);
  }
  return medians;
}

inline double deviation(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double x : values) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / n);
}

/// Mean difference of a round trip and the next one that arrived.
inline double mean_step_ms(const std::vector<double>& values) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) sum += std::abs(values[i] - values[i - 1]);
  return sum / static_cast<double>(values.size() - 1);
}

inline double lost_share(const std::vector<Ping>& pings) {
  const auto lost =
      std::count_if(pings.begin(), pings.end(), [](const Ping& p) { return p.round_trip_ms < 0; });
  return static_cast<double>(lost) / static_cast<double>(pings.size());
}

}  // namespace telekerf::netem
