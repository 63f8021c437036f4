// SPDX-License-Identifier: Apache-2.0
// A profile as a tc-netem command, and in words what that command cannot do.
#pragma once

#include <string>
#include <vector>

#include "netem/core/profile.h"

namespace telekerf::netem {

struct TcExport {
  std::string command;
  std::vector<std::string> shortcomings;  ///< what the command does otherwise than the profile says
};

/// For the egress of `device`. The command describes the profile's beginning; later stages are shortcomings.
TcExport export_to_tc(const DirectionProfile& profile, const std::string& device);

}  // namespace telekerf::netem
