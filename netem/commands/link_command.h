// SPDX-License-Identifier: Apache-2.0
// The parameters of the link between two TUN devices, which two subcommands have.
#pragma once

#include "common/runtime/settings.h"
#include "netem/drivers/tun_link.h"

namespace telekerf::netem {

void add_link_parameters(LinkOptions& options, Settings& settings);

}  // namespace telekerf::netem
