// SPDX-License-Identifier: Apache-2.0
// A profile as a tc-netem command, and in words what that command cannot do.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "netem/core/profile.h"

namespace telekerf::netem {

struct TcExport {
  std::string command;
  std::vector<std::string> shortcomings;  ///< what the command does otherwise than the profile says
};

inline constexpr std::int64_t kTcPacket_bytes = 200;
/// Between two blocks of the command stream at its defaults.
inline constexpr double kTcPacketInterval_s = 0.016;

/// For the egress of `device`. The command describes the profile's beginning; later stages are shortcomings.
/// tc counts packets where the profile counts bytes or time: `packet_bytes` says how large they are,
/// kTcPacketInterval_s how far apart.
TcExport export_to_tc(const DirectionProfile& profile, const std::string& device,
                      std::int64_t packet_bytes = kTcPacket_bytes);

}  // namespace telekerf::netem
