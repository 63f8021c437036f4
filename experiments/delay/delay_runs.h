// SPDX-License-Identifier: Apache-2.0
// The runs of telekerf-experiment delay: every rival across every network.
#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/delay/delay_rivals.h"

namespace telekerf::experiments {

inline constexpr std::array<double, 7> kRttMs{0, 20, 50, 100, 200, 400, 800};

struct Run {
  DelayTrial trial;
  Rival rival;
  codec::CodecChoice codec = codec::kDefaultCodec;
  double rtt_ms = 0.0;
  double jitter_ms = 0.0;
  double loss = 0.0;
  std::string profile;    ///< empty: the three figures above
  std::string condition;  ///< what is special about it
  double duration_s = 0.0;
  std::vector<Tuned> tuning;
  DelayResult result;
};

struct Length {
  double grid_s = 8.0;      ///< of the runs over round trip, jitter and loss, and of those that tune
  double profile_s = 30.0;  ///< of the runs on the shipped profiles
  int profile_seeds = 5;
  /// These round trips alone, at the jitter and loss that rivals are tuned for; empty: everything.
  std::vector<double> only_rtt_ms = {};
};

/// All of them; rivals are tuned for each round trip (at 10 % jitter and 1 % loss) and for each profile.
/// `said(done, of)` now and then, from any thread.
std::vector<Run> full_benchmark(const Length& length, std::uint64_t seed,
                                const std::function<void(std::size_t, std::size_t)>& said);

/// A row of delay.json.
nlohmann::ordered_json row_of(const Run& run);

/// The run of this rival with the default codec and no other condition; null if there is none.
const Run* find_run(const std::vector<Run>& runs, const Rival& rival, double rtt_ms, double jitter_share,
                    double loss);

}  // namespace telekerf::experiments
