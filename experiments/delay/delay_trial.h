// SPDX-License-Identifier: Apache-2.0
// One run across a delayed network: a recorded hand at the master, the command stream, the emulated link, the
// simulated slave. The hand feels nothing of the slave, so one recording serves every condition.
#pragma once

#include <string>
#include <vector>

#include "common/protocol/messages.h"
#include "master/command_stream.h"
#include "master/station.h"
#include "netem/core/profile.h"
#include "slave/station.h"

namespace telekerf::experiments {

/// The master's motion tick by tick from the moment when the hand is guided.
struct HandRecord {
  double beta = 0.5;
  ContourMessage contour;
  std::vector<master::KinematicState> tool;  ///< as measured, with the acceleration commanded
  std::vector<Vec3> true_tool_m;
};

/// Guides the simulated hand round `image` for `duration_s`. Throws StartupError.
HandRecord record_hand(const std::string& image, double duration_s, std::uint64_t seed);

struct DelayTrial {
  /// Commands may be as old as they ever may: it is motion that is measured, on slow networks too.
  DelayTrial() { slave.node.interlock.beam_age_s = 2.0; }
  /// Of the command stream and its law; the hand's side is in the recording.
  master::StationSettings master;
  slave::StationSettings slave;
  netem::Profile network;
  std::uint64_t seed = 1;
  bool wrong_start = false;  ///< the first idea of the slave is 10 mm and 50 mm/s off
  double push_n = 0.0;       ///< on the slave's tool from half-time on
};

/// Measures (docs/results/delay.md), as docs/reference/contract.md defines them: over every tick that was
/// applied from the end of the first approach on.
struct DelayResult {
  double tracking_rmse_um = 0.0;  ///< this and the next four: NaN if nothing was followed
  double tracking_max_um = 0.0;
  double prediction_rmse_um = 0.0;
  double prediction_max_um = 0.0;
  double settle_s = 0.0;             ///< from the first tick counted to the last one more than 1 mm off
  std::size_t counted = 0;           ///< ticks
  bool stable = false;               ///< see docs/results/delay.md
  double payload_bytes_per_s = 0.0;  ///< command stream
  double wire_bytes_per_s = 0.0;     ///< the same with every head (virtual_link.h)
  double total_ms = 0.0;             ///< from making a command to knowing what it did, observer's measure
  std::vector<double> error_m;       ///< tracking by applied tick, NaN where none was counted
  std::vector<double> prediction_error_m;
};

/// The trial; throws StartupError if its law, estimator and codec do not go together.
DelayResult run_trial(const HandRecord& hand, const DelayTrial& trial);

}  // namespace telekerf::experiments
