// SPDX-License-Identifier: Apache-2.0
// The panels of the thesis' figures 8.7 and 8.8.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/remote/remote_motion.h"

namespace telekerf::experiments {

struct RemoteMarks {
  RemoteMark fibreglass, wood;  ///< at constant power, as the thesis' laser
  RemoteMark wood_by_speed;     ///< at the power that the slave asked for
};

/// A to I as the thesis has them, and two of our own: the depth along the contour beside the operator's
/// dwell, and the same with power that follows the speed. The marks are left beside as NAME-fibreglass.png,
/// NAME-fibreglass-depth.png and NAME-wood.png. Throws StartupError.
void draw_remote(const std::string& title, const std::vector<RemoteSample>& motion, const RemoteMarks& marks,
                 const std::filesystem::path& png);

/// A run over one network.
struct NetworkRun {
  std::string network;
  std::vector<RemoteSample> motion;
  DepthAlong wood;  ///< at constant power
};

/// A panel a network: tangential velocity of the master and of the rescaled slave. Throws StartupError.
void draw_network_speeds(const std::string& title, const std::vector<NetworkRun>& runs,
                         const std::filesystem::path& png);
/// A panel a network: depth along the contour beside the operator's dwell. Throws StartupError.
void draw_network_depths(const std::string& title, const std::vector<NetworkRun>& runs,
                         const std::filesystem::path& png);

}  // namespace telekerf::experiments
