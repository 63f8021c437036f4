// SPDX-License-Identifier: Apache-2.0
// A hand on a virtual mass, and a force that comes late, lost, overtaken or from an adversary: how much
// energy the port gives to the hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace telekerf::experiments {

/// What stands between the wished force and the hand.
enum class PortLaw {
  kNone,      ///< the wished force as it is
  kObserver,  ///< passivity observer and controller: brakes by the energy up to the last step
  kTank,      ///< EnergyTank: the force is scaled before it acts
};

struct PortResult {
  PortLaw law = PortLaw::kNone;
  bool adversary = false;  ///< the force is chosen to give as much as it can
  int above = 0;           ///< runs in which the port gave more than was in the tank at the start
  double worst_j = 0.0;    ///< beyond that, largest of all runs
  double fastest_m_per_s = 0.0;
  double felt_share = 0.0;      ///< of the wished force, mean over the runs
  std::vector<double> given_j;  ///< largest of each run, ascending
};

/// Masses 0.3 to 4 kg, hands 0 to 400 N/m, gains 5 to 3000 N s/m, 0 to 0.5 s there and back with 80 ms of
/// jitter and 30 % loss; four seconds each. Run i is the same for each law.
PortResult run_port(PortLaw law, bool adversary, int runs, std::uint64_t seed);

std::string word_of(PortLaw law);

}  // namespace telekerf::experiments
