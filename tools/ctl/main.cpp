// SPDX-License-Identifier: Apache-2.0
// telekerf-tell WHAT [VALUE]: what an operator says to a running cell.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>

#include "common/bus/bus_flags.h"
#include "common/bus/send_event.h"
#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"
#include "netem/drivers/netem_flags.h"

namespace telekerf {
namespace {

struct Word {
  const char* name;
  EventMessage::Kind kind;
  const char* help;
};
using Kind = EventMessage::Kind;
constexpr std::array<Word, 4> kWords{
    {{"stop", Kind::kStop, "Emergency stop: laser off, every robot holds, until clear-stop"},
     {"clear-stop", Kind::kClearStop, "Ends an emergency stop"},
     {"engage", Kind::kEngage, "Lets the slave follow the master"},
     {"disengage", Kind::kDisengage, "Lets go of the slave: it holds its pose, laser off"}}};

struct Options {
  BusFlags bus;
  netem::NetemFlags netem;
  Settings settings;
  EventMessage event;
};

int run(Options& options) {
  options.settings.fill();
  BusSettings bus_settings = options.bus.bus_settings(Site::kOperator, "tell");
  bus_settings.receive_filter = options.netem.emulator(bus_settings.site);
  Bus bus(bus_settings);
  const std::size_t others = tell(bus, options.event);
  fmt::print("told {} processes of cell '{}'\n", others, bus.settings().cell);
  return 0;
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) {
  using namespace telekerf;
  CLI::App app("Says something to the processes of a running cell", "telekerf-tell");
  app.require_subcommand(1);
  app.fallthrough();
  Options options;
  options.bus.declare(options.settings);
  options.netem.declare(options.settings);
  options.settings.attach(app);
  Action action;
  const auto say = [&](Kind kind) {
    options.event.kind = kind;
    action = [&] { return run(options); };
  };
  for (const Word& word : kWords)
    app.add_subcommand(word.name, word.help)->callback([&say, &word] { say(word.kind); });
  auto* beta = app.add_subcommand("beta", "Slave motion = beta x master motion from now on");
  beta->add_option("value", options.event.value, "0.01 to 10")->required()->check(within(0.01, 10.0));
  beta->callback([&] { say(Kind::kSetBeta); });
  return run_program(app, argc, argv, action);
}
