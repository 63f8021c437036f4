// SPDX-License-Identifier: Apache-2.0
// The options of the link between two TUN devices, which two subcommands have.
#pragma once

#include "common/runtime/program.h"
#include "netem/drivers/tun_link.h"

namespace telekerf::netem {

void add_link_options(CLI::App& command, LinkOptions& options);

}  // namespace telekerf::netem
