// SPDX-License-Identifier: Apache-2.0
// telekerf-ctl WHAT [VALUE]: what an operator says to a running cell.
#include <fmt/format.h>

#include "common/bus/bus_flags.h"
#include "common/bus/send_event.h"
#include "common/runtime/program.h"
#include "netem/drivers/netem_flags.h"

namespace telekerf {
namespace {

struct Options {
  BusFlags bus;
  netem::NetemFlags netem;
  EventMessage event;
};

int run(const Options& options) {
  BusSettings bus_settings = options.bus.bus_settings(Site::kOperator, "ctl");
  bus_settings.receive_filter = options.netem.emulator(bus_settings.site);
  Bus bus(bus_settings);
  const std::size_t others = tell(bus, options.event);
  fmt::print("told {} processes of cell '{}'\n", others, bus.settings().cell);
  return 0;
}

Options saying(EventMessage::Kind kind) {
  Options options;
  options.event.kind = kind;
  return options;
}

void add_parameters(Options& options, Settings& settings) {
  options.bus.add_parameters(settings);
  options.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) {
  using namespace telekerf;
  using Kind = EventMessage::Kind;
  Program program("telekerf-ctl", "Says something to the processes of a running cell");
  program.add("stop", "Emergency stop: laser off, every robot holds, until clear-stop", saying(Kind::kStop),
              add_parameters, run);
  program.add("clear-stop", "Ends an emergency stop", saying(Kind::kClearStop), add_parameters, run);
  program.add("engage", "Lets the slave follow the master", saying(Kind::kEngage), add_parameters, run);
  program.add("disengage", "Lets go of the slave: it holds its pose, laser off", saying(Kind::kDisengage),
              add_parameters, run);
  program.add(
      "beta", "Slave motion = beta x master motion from now on", saying(Kind::kSetBeta),
      [](Options& options, Settings& settings) {
        settings.add("value", options.event.value, {.min = 0.01, .max = 10}, "the new scale").as_argument();
        add_parameters(options, settings);
      },
      run);
  return program.run(argc, argv);
}
