// SPDX-License-Identifier: Apache-2.0
// The whole lap in one thread and in virtual time: vision's output, master, network, slave. Deterministic:
// same settings, same record, bit by bit.
#pragma once

#include <string>

#include "common/recording/run_record.h"
#include "master/station.h"
#include "netem/core/profile.h"
#include "slave/station.h"
#include "slave/vision/contour_source.h"

namespace telekerf::simulation {

struct SimulationSettings {
  std::string image = "heart";
  double width_mm = 0.0;  ///< of the whole picture; 0: fitted to the workspace
  netem::Profile network;
  std::uint64_t seed = 1;
  double duration_s = 30.0;
  master::StationSettings master;
  slave::StationSettings slave;
};

/// The contour that vision would publish. Throws StartupError.
ContourMessage find_contour(const SimulationSettings& settings);

/// Runs the lap; the record is what the two processes would have written together.
RunRecord simulate(const SimulationSettings& settings, const ContourMessage& contour);
RunRecord simulate(const SimulationSettings& settings);

}  // namespace telekerf::simulation
