// SPDX-License-Identifier: Apache-2.0
// The recordings of a run in virtual time, as the two processes would have left them.
#pragma once

#include <filesystem>
#include <string>

#include "common/protocol/contour.h"
#include "common/recording/run_record.h"

namespace telekerf::experiments {

struct VirtualSettings {
  std::string config;  ///< as --config reads them
  std::string netem;   ///< the profile's name or file
};

/// master.h5 and slave.h5 in `folder`, which is there. Throws StartupError.
void write_virtual_run(const std::filesystem::path& folder, const RunRecord& record,
                       const ContourMessage& contour, const VirtualSettings& settings);

}  // namespace telekerf::experiments
