// SPDX-License-Identifier: Apache-2.0
// telekerf-netem switch PROFILE: the processes of a running cell put another emulated network in place.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "common/bus/bus_flags.h"
#include "common/bus/send_event.h"
#include "netem/commands/commands.h"
#include "netem/core/profile.h"
#include "netem/drivers/netem_flags.h"

namespace telekerf::netem {
namespace {

struct Options {
  std::string profile;
  BusFlags bus;
  NetemFlags netem;
  Settings settings;
};

int run(Options& options) {
  options.settings.fill();
  (void)load_profile(options.profile);  // refused here rather than by everyone in the cell
  // The others stand in other folders.
  if (std::filesystem::is_regular_file(options.profile))
    options.profile = std::filesystem::absolute(options.profile).string();
  BusSettings bus_settings = options.bus.bus_settings(Site::kOperator, "netem-switch");
  bus_settings.receive_filter = options.netem.emulator(bus_settings.site);
  Bus bus(bus_settings);
  EventMessage event;
  event.kind = EventMessage::Kind::kSetNetem;
  event.text = options.profile;
  const std::size_t others = tell(bus, event);
  fmt::print("told {} processes of cell '{}': {}\n", others, bus.settings().cell, options.profile);
  return 0;
}

}  // namespace

void add_switch_command(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("switch", "Puts another network in place in a running cell");
  auto options = std::make_shared<Options>();
  command->add_option("profile", options->profile, "a shipped name, or a file that every process can read")
      ->required();
  options->bus.declare(options->settings);
  options->netem.declare(options->settings);
  options->settings.attach(*command);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace telekerf::netem
