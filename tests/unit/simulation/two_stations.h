// SPDX-License-Identifier: Apache-2.0
// Both stations and the network between them, a step at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::simulation {

/// With the first contour of the settings' picture, at 1 kHz.
class TwoStations {
 public:
  struct Step {
    std::uint32_t command_bytes = 0, state_bytes = 0;  ///< of the frames that were sent; 0: none was
    bool lit = false;
  };

  explicit TwoStations(const SimulationSettings& settings)
      : contour_(find_contour(settings)),
        master_(settings.master),
        slave_(settings.slave),
        task_(master_.prepare(contour_)),
        corridor_(slave_.prepare(contour_)),
        forward_(settings.network.forward, settings.seed, netem::Direction::kForward),
        backward_(settings.network.backward, settings.seed, netem::Direction::kBackward) {}

  /// `n`: how many were made before.
  Step step(std::int64_t n) {
    const std::int64_t now_ns = 1'000'000 * n;
    commands_.clear();
    states_.clear();
    forward_.deliver(now_ns, commands_);
    backward_.deliver(now_ns, states_);
    Step made;
    const auto master = master_.step(now_ns, task_.get(), states_, {});
    if (master.command) made.command_bytes = forward_.push(now_ns, *master.command);
    const auto slave = slave_.step(now_ns, corridor_.get(), commands_);
    if (slave.state) made.state_bytes = backward_.push(now_ns, *slave.state);
    made.lit = slave.laser_w > 0.0;
    return made;
  }

 private:
  ContourMessage contour_;
  master::Station master_;
  slave::Station slave_;
  decltype(master_.prepare(contour_)) task_;
  decltype(slave_.prepare(contour_)) corridor_;
  VirtualLink<CommandBlock> forward_;
  VirtualLink<StateBlock> backward_;
  std::vector<Received<CommandBlock>> commands_;
  std::vector<Received<StateBlock>> states_;
};

}  // namespace telekerf::simulation
