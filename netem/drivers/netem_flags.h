// SPDX-License-Identifier: Apache-2.0
// The settings of the emulated network, which every process on the bus has, and what it leaves in the record.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/protocol/site.h"
#include "common/recording/run_file.h"
#include "common/recording/run_record.h"
#include "common/runtime/settings.h"
#include "netem/drivers/receive_path_emulator.h"

namespace telekerf::netem {

struct NetemFlags {
  std::string profile = "none";
  std::uint64_t seed = 1;

  void add_parameters(Settings& settings);
  /// What belongs into the receive path of a process at this site; null: nothing, the network is the real
  /// one. Throws StartupError if the profile cannot be loaded.
  std::shared_ptr<ReceivePathEmulator> emulator(Site own_site) const;
  /// The profile as results name it: without its folder.
  std::string name() const;
  /// A recording's, with the profile's name and file; without a file the network is the real one.
  RunIdentity with_network(RunIdentity identity) const;
};

/// What the emulator counted, as figures `netem_...` of a run; zeros without one.
void add_figures(const ReceivePathEmulator* emulator, Metrics& figures);

}  // namespace telekerf::netem
