// SPDX-License-Identifier: Apache-2.0
// Stopping a running cell from outside, and ending the stop.
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus.h"

namespace telekerf {

/// Says it at once and every 20 ms, until the control loops of master, slave and machine have acted on it;
/// who has, by role. Throws StartupError: nobody is there, one of them has not answered within 5 s, or no
/// slave is seen (the stop reaches it when it comes back, from those that have).
std::vector<std::string> send_stop(Bus& bus, const std::string& source, const std::string& reason);

/// Ends the stops that `source` has said. Throws StartupError: none is in force, or they are somebody else's,
/// or one of the stations has not answered.
std::vector<std::string> clear_stop(Bus& bus, const std::string& source);

}  // namespace telekerf
