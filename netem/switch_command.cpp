// SPDX-License-Identifier: Apache-2.0
// telekerf-netem switch PROFILE: the processes of a running cell put another emulated network in place.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <thread>

#include "common/bus/bus_flags.h"
#include "common/bus/endpoints.h"
#include "common/runtime/refusal.h"
#include "netem/commands.h"
#include "netem/profile.h"

namespace telekerf::netem {
namespace {

struct Options {
  std::string profile;
  BusFlags bus;
  Settings settings;
};

int run(Options& options) {
  options.settings.fill();
  (void)load_profile(options.profile);  // refused here rather than by everyone in the cell
  Bus bus(options.bus.bus_settings(Site::kOperator, "netem-switch"));
  Writer<EventMessage> writer(bus);
  const std::size_t others = bus.others().size();
  if (others == 0 || !writer.wait_for_reader(std::chrono::seconds(5))) {
    throw Refusal(
        fmt::format("nobody listens in cell '{}' of domain {}", bus.settings().cell, bus.settings().domain));
  }
  EventMessage event;
  event.kind = EventMessage::Kind::kSetNetem;
  event.text = options.profile;
  if (!writer.write(event)) throw Refusal("the event could not be sent");
  // Reliable delivery needs the writer alive, over slow links too.
  std::this_thread::sleep_for(std::chrono::seconds(2));
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
  options->settings.attach(*command);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace telekerf::netem
