// SPDX-License-Identifier: Apache-2.0
// telekerf-netem link PROFILE: two networks joined by an emulated link.
#include "netem/commands/link_command.h"

#include "netem/commands/commands.h"

namespace telekerf::netem {

void add_link_parameters(LinkOptions& o, Settings& s) {
  const TextForm device{"DEVICE"}, netns{"NETNS"}, address{"ADDRESS"};
  s.add("seed", o.seed, kSeeds, "of the random numbers");
  s.add("operator_dev", o.operator_side.device, device, "TUN device at the operator's side");
  s.add("slave_dev", o.slave_side.device, device, "TUN device at the slave's side");
  s.add("operator_netns", o.operator_side.netns, netns, "network namespace to put it into (name or path)");
  s.add("slave_netns", o.slave_side.netns, netns, "network namespace to put it into (name or path)");
  s.add("operator_address", o.operator_side.address, address, "of the device; empty: configure it yourself")
      .empty_is_said();
  s.add("slave_address", o.slave_side.address, address, "of the device; empty: configure it yourself")
      .empty_is_said();
  s.add("operator_default_route", o.operator_side.default_route,
        "everything from the operator's side goes over the link");
  s.add("slave_default_route", o.slave_side.default_route,
        "everything from the slave's side goes over the link");
  s.add("record", o.record, kFolder, "for the outcome of every packet: forward.csv, backward.csv");
  s.add("seconds", o.seconds, {.min = 0, .max = 1e9, .unit = "s"},
        "ends by itself after this time; 0: never");
}

void add_link_command(Program& program) {
  program.add(
      "link", "Joins two networks by an emulated link between two TUN devices", LinkOptions{},
      [](LinkOptions& o, Settings& s) {
        s.add("profile", o.profile, kProfile, "a shipped name, a TOML file or a trace").as_argument();
        add_link_parameters(o, s);
      },
      run_link);
}

}  // namespace telekerf::netem
