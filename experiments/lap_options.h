// SPDX-License-Identifier: Apache-2.0
// The settings of a run in virtual time, for those who run one and those who play it again.
#pragma once

#include <string>

#include "common/runtime/settings.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {

struct LapOptions {
  simulation::SimulationSettings lap;
  std::string netem = "thesis-constant";

  /// Conditions on it say what a recording stands for, where a run is played again.
  static constexpr const char* kReplays = "replays";

  void add_parameters(Settings& settings);
  /// What both stations share, and the network. Throws StartupError.
  simulation::SimulationSettings prepared() const;
};

}  // namespace telekerf::experiments
