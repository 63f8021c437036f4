// SPDX-License-Identifier: Apache-2.0
// The link between the sites, tried before the work: both programs send each other packets like blocks, and
// say in words what they are worth.
#pragma once

#include <string>

#include "common/bus/bus.h"

namespace telekerf {

class Settings;

struct LinkTestFlags {
  bool link_test = false;
  double link_test_s = 10.0;
  std::string peer;
  bool json = false;

  void add_parameters(Settings& settings);
};

/// Between a process of the role "master" and one of the role "slave", which both call it: packets as long as
/// a block, half of the time at the rate of the blocks and half of it at ten times that. Nothing moves.
/// Prints the verdicts, or JSON. `beam_age_s`: the slave's gate, as it says it to the master. Exit code: 0
/// good or fair, 1 bad. Throws StartupError: the other side is not there, or does not test.
int run_link_test(BusSettings settings, const LinkTestFlags& flags, double beam_age_s = 0.35);

}  // namespace telekerf
