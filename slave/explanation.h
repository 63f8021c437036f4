// SPDX-License-Identifier: Apache-2.0
// Why the beam is off and why the slave does not follow, for people; for the threads that may write.
#pragma once

#include <cstdint>
#include <string>

#include "slave/slave_node.h"

namespace telekerf::slave {

/// "beam off: ..., and ...", with every guard that forbids, the first one first. `forbidden`: bit n is guard
/// n of laser::kGuards. `wanted`: the operator asks for the beam in the sample that is applied; `lit`: it is
/// on.
std::string beam_explanation(std::uint32_t forbidden, bool wanted, bool lit);

/// "following", or why not.
std::string tracking_explanation(SlaveMode mode, HoldReason reason, std::uint32_t forbidden, bool settled);

/// Both, of one step, in a line.
std::string explanation(const SlaveOutputs& out);

}  // namespace telekerf::slave
