// SPDX-License-Identifier: Apache-2.0
// Many seeds: run, summed up, held against the bars.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/chaos/chaos_run.h"

namespace telekerf::experiments {

struct ChaosCampaign {
  int runs = 1000;
  std::uint64_t seed = 1;                       ///< of the first run
  int jobs = 0;                                 ///< at a time; changes nothing else
  std::optional<std::vector<FaultKind>> kinds;  ///< none: each seed draws its own
  ChaosSettings each;
  bool shrinks = true;  ///< of every bar missed, its first seed
};

struct ChaosReport {
  nlohmann::ordered_json json;
  bool passed = false;
  std::vector<std::string> sentences;  ///< a bar missed: what, where, and the command line that shows it
};

/// `progress`: called with the number of runs done, from any thread. Same campaign, same report.
ChaosReport run_campaign(const ChaosCampaign& campaign, const std::function<void(std::size_t)>& progress);

}  // namespace telekerf::experiments
