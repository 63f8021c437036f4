// SPDX-License-Identifier: Apache-2.0
// telekerf-master: the operator's robot, confined to the contour; streams its motion to the slave.
#include <fmt/format.h>

#include <chrono>
#include <string>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/contour_subscriber.h"
#include "common/bus/endpoints.h"
#include "common/bus/event_answers.h"
#include "common/bus/link_test.h"
#include "common/bus/process.h"
#include "common/bus/ring.h"
#include "common/bus/rival_watch.h"
#include "common/bus/stop_line.h"
#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"
#include "master/link_words.h"
#include "master/mode_words.h"
#include "master/run_recording.h"
#include "master/station.h"
#include "master/telemetry.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"

namespace telekerf::master {
namespace {

constexpr Tick kTelemetryTicks = 10;  // between two looks at the values
constexpr std::chrono::milliseconds kTelemetryPeriod{20};

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  StationSettings station;
  StopFlags stop;
  LinkTestFlags link;
  RecordFlags record;
  std::string config;
  double duration_s = 0.0;
  double wait_s = 20.0;
  void validate() const { (void)station.validated(); }
};

constexpr Lookout::Wish kContourMissing{"a contour", "vision"};
constexpr Lookout::Wish kSlaveMissing{"the states of a slave", "slave"};

const Lookout::Wish* missing_of(bool contour, bool slave, MasterMode mode) {
  if (mode == MasterMode::kStopped) return nullptr;
  return !contour ? &kContourMissing : !slave ? &kSlaveMissing : nullptr;
}

RivalWatch::Obeyed obeyed_by(const StateHeader* slave, bool gone, std::uint32_t epoch) {
  if (gone) return RivalWatch::Obeyed::kUnheard;
  if (slave == nullptr || slave->master_epoch == 0) return RivalWatch::Obeyed::kNobody;
  return slave->master_epoch == epoch ? RivalWatch::Obeyed::kUs : RivalWatch::Obeyed::kAnother;
}

int run(Flags& flags) {
  flags.record.validate("master");
  BusSettings settings = flags.bus.bus_settings(Site::kOperator, "master");
  const auto emulator = flags.netem.emulator(settings.site);
  settings.receive_filter = emulator;
  if (!flags.link.peer.empty()) settings.peers.push_back(flags.link.peer);
  if (flags.link.link_test) return run_link_test(settings, flags.link);
  flags.station.epoch = settings.epoch;
  flags.station.record_s = 0.0;  // rows go into the file
  Station station(flags.station);

  Process process(settings, "master", text_of(MasterMode::kIdle, nullptr, false, 0));
  StatusReporter& status = process.status();
  Reader<StateBlock> states(process.bus());
  Reader<EventMessage> events(process.bus());
  StopLine emergency(process.bus(), flags.stop.path(settings));
  Writer<CommandBlock> commands(process.bus());
  Writer<TelemetryMessage> telemetry(process.bus());
  const netem::NetemSwitch netem_switch(process.bus(), emulator);
  ContourSubscriber<GuidedContour> contour(
      process.bus(), [&](const ContourMessage& message) { return station.prepare(message); });
  if (station.machine().plant() == nullptr) {
    const bool nobody = flags.station.button == "hand" && flags.station.hand_device == "simulated";
    status.say(fmt::format("{} is not simulated, so no hand is either: it feels a real one; button = {}{}",
                           flags.station.machine.drive, flags.station.button, nobody ? ": never held" : ""));
  }
  RunRecording recording(flags.record,
                         flags.netem.with_network(run_identity(settings, "telekerf-master", flags.config)),
                         station, status);

  std::vector<Received<StateBlock>> arrived_states;
  std::vector<EventMessage> arrived_events;
  arrived_states.reserve(64);
  arrived_events.reserve(64);
  Snapshot values;
  EventAnswers answers(process.bus());
  RivalWatch rivals(process.bus(), status);
  LinkWords link;
  Ring<EventVerdict> verdicts(64);
  const Periodic beside(kTelemetryPeriod, [&] {
    if (const auto newest = values.load()) {
      telemetry.write(*newest);
      recording.values(*newest);
    }
    recording.contours(contour.adopted());
    while (const auto verdict = verdicts.take()) {
      if (verdict->refusal != nullptr) status.say(verdict->refusal);
      if (verdict->asker != 0)
        answers.give(verdict->asker, verdict->refusal == nullptr ? "" : verdict->refusal);
    }
    answers.again();
    rivals.look();
    if (const std::string said = link.due(std::chrono::steady_clock::now()); !said.empty()) status.say(said);
  });
  double engaged_s = 0.0, waited_s = 0.0;
  const LoopStatistics loop = process.run(flags.station.node.control_hz, [&](std::int64_t now_ns) {
    drain(states, arrived_states);
    drain(events, arrived_events);
    process.let_go_with_keys(arrived_events);
    GuidedContour* const task = contour.current();
    const StationOutputs out = station.step(now_ns, task, arrived_states, arrived_events, emergency.order());
    recording.step(now_ns, arrived_states, arrived_events, out);
    emergency.obeyed(out.stop);
    if (out.say_stop) emergency.say();
    if (out.prepare_anew) contour.request_rebuild();
    if (out.command) commands.write(*out.command);
    // Who is stopped does not wait for anybody.
    if (out.mode == MasterMode::kEngaged)
      engaged_s += station.control_period_s();
    else if (out.mode != MasterMode::kStopped)
      waited_s += station.control_period_s();
    const StateHeader* const slave = station.node().slave();
    status.state(text_of(out.mode, slave, slave != nullptr && slave->master_epoch == settings.epoch,
                         task != nullptr ? task->guide.contour_id : 0, out.off_line));
    if (out.let_go != nullptr) verdicts.push({0, out.let_go});  // nobody has asked
    for (std::size_t n = 0; n < out.verdict_count; ++n) verdicts.push(EventVerdict(out.verdicts[n]));
    process.lookout().refused(Lookout::Device::kDrive, station.machine().refused());
    process.lookout().refused(Lookout::Device::kButton, station.button_refused());
    process.lookout().refused(Lookout::Device::kHand, station.hand_refused());
    // What was refused with a sentence has come.
    process.lookout().missing(missing_of(task != nullptr || contour.refused(), slave != nullptr, out.mode));
    if (flags.duration_s > 0.0) status.progress(engaged_s / flags.duration_s, flags.duration_s);
    const MasterNode& node = station.node();
    if (node.tick() % kTelemetryTicks == 0)
      values.store(node.tick(), master_values(out, task ? task->guide.beta : 1.0, node.link().clocks(),
                                              node.link().newest_rtt_s(), station.stream()));
    link.step(now_ns, node.slave_silent_s(now_ns), slave);
    const bool goes_on = rivals.goes_on(obeyed_by(slave, node.slave_gone(now_ns), settings.epoch));
    const bool done = flags.duration_s > 0.0 && (engaged_s >= flags.duration_s || waited_s >= flags.wait_s);
    return goes_on && !done && !station.machine().failed() && station.obstacle() == nullptr;
  });
  station.release();

  const bool failed = station.machine().failed();
  if (station.obstacle() != nullptr) throw configuration_error(station.obstacle());
  RunRecord record;
  recording.contours(contour.adopted());
  station.report_contours(contour.adopted(), record);
  record.words["netem"] = flags.netem.name();
  station.report(record);
  add_figures(loop, record.master_figures);
  add_figures(process.bus().counters(), states.counters(), record.master_figures);
  netem::add_figures(emulator.get(), record.master_figures);
  netem_switch.add_figures(record.master_figures);
  if (recording.close(record) && contour.current() != nullptr) {
    write_contour(recording.folder(), record);
    write_master(recording.folder(), record);
  }
  if (const std::string why = rivals.sentence(); !why.empty()) throw environment_error(why);
  process.refuse_ended();
  if (flags.duration_s > 0.0 && engaged_s < flags.duration_s && !stop_requested() && !failed) {
    if (contour.refused()) throw input_error(contour.refusal());
    throw environment_error(fmt::format(
        "nobody to work with for {:.0f} s in {}: are telekerf-vision and telekerf-slave running there?",
        flags.wait_s, process.place()));
  }
  if (failed) throw hardware_error(station.machine().failure());
  recording.refuse_unfinished();
  status.say(fmt::format("ended in order after {:.0f} s engaged", engaged_s));
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  flags.station.add_parameters(settings);
  flags.stop.add_parameters(settings);
  flags.record.add_parameters(settings);
  settings.add("engage", flags.station.engage, "lets the slave follow as soon as everything is ready");
  settings.add("duration_s", flags.duration_s, {.min = 0, .max = 36000, .unit = "s"},
               "ends after this long engaged; 0: runs on");
  settings.add("wait_s", flags.wait_s, {.min = 1, .max = 3600, .unit = "s"},
               "with duration_s: gives up after this long not engaged");
  flags.link.add_parameters(settings);
  flags.bus.add_parameters(settings);
  flags.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf::master

int main(int argc, char** argv) {
  using namespace telekerf::master;
  return telekerf::run_program(
      argc, argv, "telekerf-master",
      "The operator's robot: confines the hand to the contour and streams its motion", Flags{},
      add_parameters, run);
}
