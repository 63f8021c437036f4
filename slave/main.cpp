// SPDX-License-Identifier: Apache-2.0
// telekerf-slave: the robot with the laser follows what the master streams.
#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/contour_subscriber.h"
#include "common/bus/endpoints.h"
#include "common/bus/link_test.h"
#include "common/bus/process.h"
#include "common/bus/stop_line.h"
#include "common/protocol/sentences.h"
#include "common/runtime/clock.h"
#include "common/runtime/program.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"
#include "slave/explainer.h"
#include "slave/look_log.h"
#include "slave/run_recording.h"
#include "slave/station.h"

namespace telekerf::slave {
namespace {

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  StationSettings station;
  StopFlags stop;
  LinkTestFlags link;
  RecordFlags record;
  std::string config;
  void validate() const { (void)station.validated(); }
};

const char* text_of(SlaveMode mode, HoldReason reason) {
  switch (mode) {
    case SlaveMode::kWaiting:
      return "waiting for the master's commands";
    case SlaveMode::kFollowing:
      return "following";
    case SlaveMode::kHolding:
      return reason == HoldReason::kSilent ? "holding its place, laser off: no commands arrive"
                                           : sentence_of(reason);
    case SlaveMode::kStopped:
      return "stopped: laser off until clear-stop";
  }
  return "unknown";
}

constexpr Lookout::Wish kContourMissing{"a contour", "vision"};
constexpr Lookout::Wish kCommandsMissing{"a master's commands", "master"};

const Lookout::Wish* missing_of(bool contour, HoldReason reason) {
  if (!contour) return &kContourMissing;
  return reason == HoldReason::kNoCommands ? &kCommandsMissing : nullptr;
}

int run(Flags& flags) {
  flags.record.validate("slave");
  BusSettings settings = flags.bus.bus_settings(Site::kSlave, "slave");
  const auto emulator = flags.netem.emulator(settings.site);
  settings.receive_filter = emulator;
  if (!flags.link.peer.empty()) settings.peers.push_back(flags.link.peer);
  if (flags.link.link_test)
    return run_link_test(settings, flags.link, flags.station.node.interlock.beam_age_s);
  flags.station.epoch = settings.epoch;
  flags.station.record_s = 0.0;  // rows go into the file
  Station station(flags.station);

  Process process(settings, "slave", text_of(SlaveMode::kWaiting, HoldReason::kNoCommands));
  Reader<CommandBlock> commands(process.bus());
  StopLine emergency(process.bus(), flags.stop.path(settings));
  Writer<StateBlock> states(process.bus());
  netem::NetemSwitch netem_switch(process.bus(), emulator);
  ContourSubscriber<Corridor> contour(
      process.bus(), [&](const ContourMessage& message) { return station.prepare(message); });
  if (station.machine().plant() == nullptr)
    process.status().say(flags.station.machine.drive + " is not simulated: the measured tool is recorded");
  RunRecording recording(flags.record,
                         flags.netem.with_network(run_identity(settings, "telekerf-slave", flags.config)),
                         station, process.status());
  process.status().say(fmt::format("commands older than {:g} s, there and back, give no light (--beam-age-s)",
                                   flags.station.node.interlock.beam_age_s));

  const double look_age_s = flags.station.node.interlock.max_look_age_s;
  process.status().say(
      look_age_s > 0.0
          ? fmt::format("no light when vision has not seen the contour for {:g} s (--look-age-s)", look_age_s)
          : "nobody asks how long ago vision has seen the contour (--look-age-s 0)");
  LookLog looks;
  // Only if somebody asks: the master tells fifty times a second, which would cross the network too.
  std::optional<Reader<TelemetryMessage>> vision;
  if (look_age_s > 0.0) {
    vision.emplace(process.bus(),
                   [&looks](const TelemetryMessage& message) { looks.hear(message, monotonic_ns()); });
  }

  std::vector<Received<CommandBlock>> arrived_commands;
  arrived_commands.reserve(64);
  std::optional<Explainer> explainer(std::in_place, process.status());
  const Periodic beside(std::chrono::milliseconds(500), [&] { recording.contours(contour.adopted()); });
  const LoopStatistics loop = process.run(flags.station.node.control_hz, [&](std::int64_t now_ns) {
    drain(commands, arrived_commands);
    const Corridor* const corridor = contour.current();
    const SlaveOutputs out =
        station.step(now_ns, corridor, arrived_commands, emergency.order(),
                     corridor != nullptr ? looks.age_s(corridor->contour_id, now_ns) : laser::kAbsent);
    recording.step(now_ns, corridor, arrived_commands, out);
    emergency.obeyed(out.stop);
    if (out.state) states.write(*out.state);
    process.status().state(text_of(out.mode, out.reason));
    explainer->step(out);
    netem_switch.beam(out.laser_w > 0.0);
    process.lookout().refused(Lookout::Device::kDrive, station.machine().refused());
    process.lookout().refused(Lookout::Device::kLaser, station.beam().refused());
    // What was refused with a sentence has come.
    process.lookout().missing(missing_of(corridor != nullptr || contour.refused(), out.reason));
    return !station.machine().failed() && !station.beam().failed();
  });
  explainer.reset();  // what follows is no reason to wait for
  station.release();

  RunRecord record;
  recording.contours(contour.adopted());
  station.report(record);
  record.slave_figures["contours_refused"] = static_cast<double>(contour.unfit());
  add_figures(loop, record.slave_figures);
  add_figures(process.bus().counters(), commands.counters(), record.slave_figures);
  netem::add_figures(emulator.get(), record.slave_figures);
  netem_switch.add_figures(record.slave_figures);
  if (recording.close(record)) write_slave(recording.folder(), record);
  if (station.machine().failed()) throw hardware_error(station.machine().failure());
  if (station.beam().failed()) throw hardware_error(station.beam().failure());
  process.refuse_ended();
  recording.refuse_unfinished();
  process.status().say("ended in order, laser off");
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  flags.station.add_parameters(settings);
  flags.stop.add_parameters(settings);
  flags.record.add_parameters(settings);
  flags.link.add_parameters(settings);
  flags.bus.add_parameters(settings);
  flags.netem.add_parameters(settings);
  settings.moved("automatic", "is a program of its own now: telekerf-machine");
  for (const char* name : {"speed_mm_s", "controller", "corner", "material", "sensor", "kerf_um",
                           "no_framing", "machining_hz", "wait_s"})
    settings.moved(name, "belongs to telekerf-machine now");
}

}  // namespace
}  // namespace telekerf::slave

int main(int argc, char** argv) {
  using namespace telekerf::slave;
  return telekerf::run_program(argc, argv, "telekerf-slave",
                               "The robot with the laser: follows the master's stream", Flags{},
                               add_parameters, run);
}
