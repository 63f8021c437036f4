// SPDX-License-Identifier: Apache-2.0
// One event from outside to everyone in a running cell, and what they make of it.
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/protocol/messages.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// To be thrown where a cell is spoken to that has nobody in it.
StartupError nobody_listens(const Bus& bus);

/// Sends `event`, to some of them perhaps twice, and waits for what the processes of these roles make of it,
/// over slow links too. The roles that have done it. Throws StartupError: nobody of these roles is there, one
/// has refused it (the sentence says who and why), or one has not answered within 5 s.
std::vector<std::string> tell(Bus& bus, EventMessage event, const std::vector<std::string>& roles);

}  // namespace telekerf
