// SPDX-License-Identifier: Apache-2.0
// One event from outside to everyone in a running cell.
#pragma once

#include "common/bus/bus.h"
#include "common/protocol/messages.h"

namespace telekerf {

/// Sends `event`, to some of them perhaps twice, and stays until it is delivered, over slow links too. How
/// many processes are in the cell. Throws StartupError: nobody listens.
std::size_t tell(Bus& bus, const EventMessage& event);

}  // namespace telekerf
