// SPDX-License-Identifier: Apache-2.0
// Robots, hands and networks drawn at random: what the chosen gains have to work on without being tuned.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {

/// One drawn run. Robots are one of the shipped ones, grown or shrunk (lengths 0.8 to 1.25, rods 2 %
/// unequal), with masses x 0.5 to 2, forces x 0.7 to 1.5, friction x 0.3 to 3, an encoder step of 0.1 to 2
/// um, and every third one with a drive delay of up to 1.5 ms; what the station believes is off by a mismatch
/// of up to 30 %. The hand moves at 5 to 40 mm/s, pushes with up to half of the motors' peak force, every
/// third one with up to 30 N, and knocks, slips, fights or lets go up to three times. Beta 0.2 to 2, any
/// shipped picture, any shipped profile.
struct RandomSite {
  simulation::SimulationSettings settings;
  nlohmann::ordered_json drawn;  ///< what was drawn, for the reader
};

/// Same seed, same site. The robots' files are written into `folder`.
RandomSite random_site(std::uint64_t seed, double duration_s, const std::filesystem::path& folder);

}  // namespace telekerf::experiments
