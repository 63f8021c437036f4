// SPDX-License-Identifier: Apache-2.0
// A recorded run once more in virtual time: the recorded operator, contour and network through the same
// nodes, with the recorded settings or others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/recording/run_record.h"
#include "common/runtime/settings.h"
#include "experiments/lap_options.h"
#include "experiments/replay/recorded_network.h"

namespace telekerf::experiments {

/// Beside its report: how a replay differs from the run.
inline constexpr const char* kReplayFile = "replay.json";

/// What a replay is made of.
struct RecordedRun {
  RunRecord record;
  bool virtual_time = false;
  std::string settings;  ///< of a run in virtual time; those of a real one's stations, as far as it has them
  std::string network;   ///< of a run in virtual time: the profile's file
  std::string network_name;
  std::vector<RecordedBlock> commands, states;  ///< of a real run: what became of each
  ContourMessage contour;
  std::vector<simulation::TimedEvent> events;
  std::vector<simulation::TimedStop> stops;
  Tick contour_from_tick = 0;
  double slave_starts_s = 0.0;  ///< after the master, by the estimate of its clock
};
/// Throws StartupError that names what is missing.
RecordedRun read_recorded(std::span<const std::filesystem::path> folders);

/// `given`: settings that take the place of the recorded ones, as --config reads them. Throws StartupError.
RunRecord replay(const RecordedRun& run, const std::string& given);

}  // namespace telekerf::experiments
