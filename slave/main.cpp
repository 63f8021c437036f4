// SPDX-License-Identifier: Apache-2.0
// telekerf-slave: the robot with the laser follows what the master streams.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/contour_subscriber.h"
#include "common/bus/endpoints.h"
#include "common/runtime/loop.h"
#include "common/runtime/program.h"
#include "common/runtime/results.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"
#include "slave/machining/process.h"
#include "slave/station.h"

namespace telekerf::slave {
namespace {

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  StationSettings station;
  std::string record;
  bool automatic = false;
  machining::AutomaticSettings automatic_settings;
};

const char* name_of(SlaveMode mode) {
  switch (mode) {
    case SlaveMode::kWaiting:
      return "waiting";
    case SlaveMode::kFollowing:
      return "following";
    case SlaveMode::kHolding:
      return "holding, the stream has dried up";
    case SlaveMode::kStopped:
      return "stopped";
  }
  return "unknown";
}

int run(Flags& flags) {
  if (!flags.record.empty()) refuse_unwritable("--record", flags.record);
  BusSettings bus_settings = flags.bus.bus_settings(Site::kSlave, "slave");
  const auto emulator = flags.netem.emulator(bus_settings.site);
  bus_settings.receive_filter = emulator;
  flags.station.epoch = bus_settings.epoch;
  if (flags.automatic) {
    return machining::run_automatic(bus_settings, flags.automatic_settings,
                                    {flags.station.robot, flags.station.machine, flags.station.mismatch,
                                     flags.station.seed, flags.station.node.laser_w, flags.station.beam},
                                    flags.record);
  }
  Station station(flags.station);
  const robot::RobotSupervisor& machine = station.machine();
  const laser::LaserOutput& beam = station.beam();
  if (machine.plant() == nullptr) {
    fmt::print("slave: {} is not simulated: what is recorded is the measured tool\n",
               flags.station.machine.drive);
  }
  catch_stop_signals();
  Bus bus(bus_settings);
  Reader<CommandBlock> commands(bus);
  Reader<EventMessage> events(bus);
  Writer<StateBlock> states(bus);
  const netem::NetemSwitch netem_switch(bus, emulator);
  ContourSubscriber<Corridor> contour(
      bus, [&](const ContourMessage& message) { return station.prepare(message); });
  fmt::print("slave: ready in {}\n", bus_settings.cell);
  std::fflush(stdout);

  std::vector<Received<CommandBlock>> arrived_commands;
  std::vector<EventMessage> arrived_events;
  arrived_commands.reserve(64);
  arrived_events.reserve(64);
  std::atomic<SlaveMode> mode{SlaveMode::kWaiting};
  std::jthread herald([&](const std::stop_token& stop) {
    for (SlaveMode said = SlaveMode::kWaiting; !stop.stop_requested();
         std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      if (const SlaveMode now = mode.load(); now != said) {
        said = now;
        fmt::print("slave: {}\n", name_of(now));
        std::fflush(stdout);
      }
    }
  });

  const LoopStatistics loop = run_loop(flags.station.node.control_hz, [&](std::int64_t now_ns) {
    drain(commands, arrived_commands);
    drain(events, arrived_events);
    const SlaveOutputs out = station.step(now_ns, contour.current(), arrived_commands, arrived_events);
    if (out.state) states.write(*out.state);
    mode.store(out.mode, std::memory_order_relaxed);
    return !stop_requested() && !contour.refused() && !machine.failed() && !beam.failed();
  });
  station.release();
  herald.request_stop();

  if (!flags.record.empty()) {
    RunRecord record;
    station.report(record);
    add_figures(loop, record.slave_figures);
    add_figures(bus.counters(), commands.counters(), record.slave_figures);
    netem::add_figures(emulator.get(), record.slave_figures);
    write_slave(flags.record, record);
  }
  if (contour.refused()) throw StartupError(contour.refusal());
  if (machine.failed()) throw StartupError(machine.failure());
  if (beam.failed()) throw StartupError(beam.failure());
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  flags.station.declare(settings);
  settings.add("record", flags.record, kFolder, "folder to record the run into");
  settings.add("automatic", flags.automatic, "machines the contour that vision publishes, without a master");
  flags.automatic_settings.declare(settings);
  flags.bus.declare(settings);
  flags.netem.declare(settings);
}

}  // namespace
}  // namespace telekerf::slave

int main(int argc, char** argv) {
  using namespace telekerf::slave;
  return telekerf::run_program(argc, argv, "telekerf-slave",
                               "The robot with the laser: follows the master's stream", Flags{},
                               add_parameters, run);
}
