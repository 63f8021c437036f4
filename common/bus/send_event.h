// SPDX-License-Identifier: Apache-2.0
// One event from outside to everyone in a running cell.
#pragma once

#include "common/bus/bus.h"
#include "common/protocol/messages.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// To be thrown where a cell is spoken to that has nobody in it.
StartupError nobody_listens(const Bus& bus);

/// Sends `event`, to some of them perhaps twice, and stays until it is delivered, over slow links too. How
/// many processes are in the cell. Throws StartupError: nobody listens.
std::size_t tell(Bus& bus, const EventMessage& event);

}  // namespace telekerf
