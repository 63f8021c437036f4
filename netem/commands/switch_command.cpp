// SPDX-License-Identifier: Apache-2.0
// telekerf-netem switch PROFILE: the processes of a running cell put another emulated network in place.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "common/bus/bus_flags.h"
#include "common/bus/send_event.h"
#include "netem/commands/commands.h"
#include "netem/core/profile.h"
#include "netem/drivers/netem_flags.h"

namespace telekerf::netem {
namespace {

struct SwitchOptions {
  std::string profile;
  BusFlags bus;
  NetemFlags netem;
};

int run_switch(SwitchOptions& options) {
  (void)load_profile(options.profile);  // refused here rather than by everyone in the cell
  // The others stand in other folders.
  if (std::filesystem::is_regular_file(options.profile))
    options.profile = std::filesystem::absolute(options.profile).string();
  BusSettings bus_settings = options.bus.bus_settings(Site::kOperator, "ctl");
  if (bus_settings.name.empty()) bus_settings.name = "netem-switch";
  bus_settings.receive_filter = options.netem.emulator(bus_settings.site);
  Bus bus(bus_settings);
  EventMessage event;
  event.kind = EventMessage::Kind::kSetNetem;
  event.text = options.profile;
  const auto switched = tell(bus, event, {"master", "slave", "vision"});
  fmt::print("the network of cell '{}' is now {}, at {}\n", bus.settings().cell, options.profile,
             fmt::join(switched, ", "));
  return 0;
}

}  // namespace

void add_switch_command(Program& program) {
  program.add(
      "switch", "Puts another network in place in a running cell", SwitchOptions{},
      [](SwitchOptions& o, Settings& s) {
        s.add("profile", o.profile, kProfile, "a shipped name, or a file that every process can read")
            .as_argument();
        o.bus.add_parameters(s);
        o.netem.add_parameters(s);
      },
      run_switch);
}

}  // namespace telekerf::netem
