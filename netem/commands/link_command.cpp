// SPDX-License-Identifier: Apache-2.0
// telekerf-netem link PROFILE: two networks joined by an emulated link.
#include "netem/commands/link_command.h"

#include <memory>

#include "netem/commands/commands.h"

namespace telekerf::netem {

void add_link_options(CLI::App& command, LinkOptions& options) {
  command.add_option("--seed", options.seed, "of the random numbers")
      ->check(whole_number())
      ->capture_default_str();
  command.add_option("--operator-dev", options.operator_side.device, "TUN device at the operator's side")
      ->capture_default_str();
  command.add_option("--slave-dev", options.slave_side.device, "TUN device at the slave's side")
      ->capture_default_str();
  command.add_option("--operator-netns", options.operator_side.netns,
                     "network namespace to put it into (name or path)");
  command.add_option("--slave-netns", options.slave_side.netns,
                     "network namespace to put it into (name or path)");
  command
      .add_option("--operator-address", options.operator_side.address,
                  "of the device; empty: configure it yourself")
      ->capture_default_str();
  command
      .add_option("--slave-address", options.slave_side.address,
                  "of the device; empty: configure it yourself")
      ->capture_default_str();
  command.add_flag("--operator-default-route", options.operator_side.default_route,
                   "everything from the operator's side goes over the link");
  command.add_flag("--slave-default-route", options.slave_side.default_route,
                   "everything from the slave's side goes over the link");
  command.add_option("--record", options.record,
                     "folder for the fate of every packet: forward.csv, backward.csv");
  command.add_option("--seconds", options.seconds, "stop by itself")->check(within(0, 1e9));
}

void add_link_command(CLI::App& app, Action& action) {
  auto* command =
      app.add_subcommand("link", "Joins two networks by an emulated link between two TUN devices");
  auto options = std::make_shared<LinkOptions>();
  command->add_option("profile", options->profile, "a shipped name, a TOML file or a trace")->required();
  add_link_options(*command, *options);
  command->callback([options, &action] { action = [options] { return run_link(*options); }; });
}

}  // namespace telekerf::netem
