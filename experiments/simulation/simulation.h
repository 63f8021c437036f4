// SPDX-License-Identifier: Apache-2.0
// Both stations and the network between them in one thread and in virtual time. Deterministic: same settings,
// same record, bit by bit.
#pragma once

#include <string>
#include <vector>

#include "common/recording/run_record.h"
#include "master/station.h"
#include "netem/core/profile.h"
#include "slave/station.h"
#include "slave/vision/contour_source.h"

namespace telekerf::simulation {

/// An event that both stations hear in their first step at or after `at_s`.
struct TimedEvent {
  double at_s = 0.0;
  EventMessage event;
};

/// What both stations are told of the emergency stop from then on.
struct TimedStop {
  double at_s = 0.0;
  StopOrder order;
};

struct SimulationSettings {
  SimulationSettings() { master.engage = true; }
  std::string image = "heart";
  double width_mm = 0.0;  ///< of the whole picture; 0: fitted to the workspace
  netem::Profile network;
  std::uint64_t seed = 1;
  double duration_s = 30.0;
  master::StationSettings master;
  slave::StationSettings slave;
  std::vector<TimedEvent> events;  ///< in order of time
  std::vector<TimedStop> stops;    ///< likewise
  /// The operator's force and button, a row a control step, instead of the simulated hand.
  std::vector<MasterRow> hand;
  Tick contour_from_tick = 0;   ///< of the master: there is no contour before
  double slave_starts_s = 0.0;  ///< after the master; negative: before
};

/// The contour that vision would publish. Throws StartupError.
ContourMessage find_contour(const SimulationSettings& settings);

/// The record is what the two processes would have written together.
RunRecord simulate(const SimulationSettings& settings, const ContourMessage& contour);
RunRecord simulate(const SimulationSettings& settings);

}  // namespace telekerf::simulation
