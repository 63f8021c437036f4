// SPDX-License-Identifier: Apache-2.0
// The settings that every process on the bus shares, as configuration keys and flags.
#pragma once

#include <string>

#include "common/bus/bus.h"
#include "common/bus/endpoints.h"
#include "common/recording/run_file.h"
#include "common/recording/run_record.h"
#include "common/runtime/settings.h"

namespace telekerf {

struct BusFlags {
  int domain = 0;
  std::string cell = "cell-1";
  std::string name;
  std::string peers;
  std::string security;
  bool wan = false;
  bool insecure = false;

  void add_parameters(Settings& settings);
  /// Settings for a process of this role; the epoch is taken from the wall clock, so that a later start has a
  /// higher one.
  BusSettings bus_settings(Site site, const std::string& role) const;
};

/// Whose recording it is: the process' role, cell and epoch, and the settings that it was given.
RunIdentity run_identity(const BusSettings& settings, const std::string& program, const std::string& config);

/// What the bus counted, as figures of a run; `stream`: the reader of the other site's blocks.
void add_figures(const BusCounters& counters, const ReaderCounters& stream, Metrics& figures);

}  // namespace telekerf
