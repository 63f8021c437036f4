// SPDX-License-Identifier: Apache-2.0
// The link driver: two TUN devices, an emulator for each direction between them. Any IP traffic, any program.
#pragma once

#include <cstdint>
#include <string>

#include "netem/drivers/tun.h"

namespace telekerf::netem {

struct LinkOptions {
  std::string profile;
  std::uint64_t seed = 1;
  TunSettings operator_side{"tk-operator", "", "10.77.0.1/24", false};
  TunSettings slave_side{"tk-slave", "", "10.77.0.2/24", false};
  double seconds = 0.0;  ///< 0: until SIGINT or SIGTERM
  std::string record;  ///< folder for forward.csv and backward.csv, what became of every packet; empty: none
};

/// Forwards until it is told to stop, then prints what happened to the packets. SIGHUP reads the profile
/// again and switches to it without a gap. Returns 1 if packets were lost otherwise than the profile says.
/// Throws StartupError.
int run_link(const LinkOptions& options);

}  // namespace telekerf::netem
