// SPDX-License-Identifier: Apache-2.0
// telekerf-master: the operator's robot, confined to the contour; streams its motion to the slave.
#include <fmt/format.h>
#include <unistd.h>

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
#include "master/station.h"
#include "master/telemetry.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"

namespace telekerf::master {
namespace {

constexpr Tick kTelemetryTicks = 10;  // between two looks at the values; published 50 times a second

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  StationSettings station;
  std::string record;
  bool engage = false;
  double duration_s = 0.0;
  double wait_s = 20.0;
};

const char* name_of(MasterMode mode) {
  switch (mode) {
    case MasterMode::kIdle:
      return "waiting for a contour";
    case MasterMode::kApproach:
      return "moving to the contour";
    case MasterMode::kGuiding:
      return "guiding the hand; the slave does not follow";
    case MasterMode::kEngaged:
      return "engaged: the slave follows";
    case MasterMode::kStopped:
      return "stopped";
  }
  return "unknown";
}

/// What the loop lets the herald see.
struct Progress {
  std::atomic<MasterMode> mode{MasterMode::kIdle};
  std::atomic<double> engaged_s{0.0};
  Snapshot values;
};

/// Publishes what constraint and observer do, fifty times a second. Says every change of mode; to a terminal
/// also a bar.
void announce(const std::stop_token& stop, const Progress& progress, double duration_s,
              Writer<TelemetryMessage>& telemetry) {
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  MasterMode said = MasterMode::kIdle;
  for (unsigned round = 0; !stop.stop_requested(); ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (const auto values = progress.values.load()) telemetry.write(*values);
    if (round % 5 != 0) continue;
    const MasterMode mode = progress.mode.load();
    if (mode != said) {
      said = mode;
      fmt::print("{}master: {}\n", terminal ? "\r\033[K" : "", name_of(mode));
    }
    const double share = duration_s > 0.0 ? progress.engaged_s.load() / duration_s : 0.0;
    if (terminal && share > 0.0) {
      constexpr int kWidth = 40;
      const int full = std::min(kWidth, static_cast<int>(share * kWidth));
      fmt::print("\r  cutting [{:#<{}}{:.<{}}] {:4.1f} s of {:.0f} s", "", full, "", kWidth - full,
                 progress.engaged_s.load(), duration_s);
    }
    std::fflush(stdout);
  }
  if (terminal) fmt::print("\r\033[K");
}

void record_run(const Flags& flags, const Station& station, const ContourSubscriber<GuidedContour>& contour,
                const Bus& bus, const netem::ReceivePathEmulator* emulator, const ReaderCounters& states,
                const LoopStatistics& loop) {
  RunRecord record;
  const ContourMessage message = contour.message();
  for (const auto& point : message.points_m) record.contour_m.push_back({point.x(), point.y()});
  record.contour_closed = message.closed;
  record.words["image"] = message.source;
  record.words["mode"] = message.mode;
  record.words["netem"] = flags.netem.name();
  station.report(record);
  add_figures(loop, record.master_figures);
  add_figures(bus.counters(), states, record.master_figures);
  netem::add_figures(emulator, record.master_figures);
  write_contour(flags.record, record);
  write_master(flags.record, record);
}

int run(Flags& flags) {
  if (!flags.record.empty()) refuse_unwritable("--record", flags.record);
  BusSettings bus_settings = flags.bus.bus_settings(Site::kOperator, "master");
  const auto emulator = flags.netem.emulator(bus_settings.site);
  bus_settings.receive_filter = emulator;
  flags.station.epoch = bus_settings.epoch;
  Station station(flags.station);
  const robot::RobotSupervisor& machine = station.machine();
  if (machine.plant() == nullptr) {
    fmt::print("master: {} is not simulated, so no hand is either: it feels a real one; button = {}{}\n",
               flags.station.machine.drive, flags.station.button,
               flags.station.button == "hand" ? ": never held" : "");
  }
  catch_stop_signals();
  Bus bus(bus_settings);
  Reader<StateBlock> states(bus);
  Reader<EventMessage> events(bus);
  Writer<CommandBlock> commands(bus);
  const netem::NetemSwitch netem_switch(bus, emulator);
  Writer<TelemetryMessage> telemetry(bus);
  std::atomic<double> wanted_beta{flags.station.beta};
  double beta = flags.station.beta;  // in force; only the watch's own thread needs it
  ContourSubscriber<GuidedContour> contour(bus, [&](const ContourMessage& message) {
    double wanted = wanted_beta.load();
    try {
      auto task = station.prepare(message, wanted);
      beta = task->guide.beta;
      return task;
    } catch (const StartupError&) {
      wanted_beta.compare_exchange_strong(wanted, beta);  // unless another has been asked for meanwhile
      throw;
    }
  });
  fmt::print("master: ready in {}\n", bus_settings.cell);
  std::fflush(stdout);

  std::vector<Received<StateBlock>> arrived_states;
  std::vector<EventMessage> arrived_events;
  arrived_states.reserve(64);
  arrived_events.reserve(64);
  Progress progress;
  bool engage = flags.engage;
  double engaged_s = 0.0;
  double waited_s = 0.0;
  std::jthread herald(
      [&](const std::stop_token& stop) { announce(stop, progress, flags.duration_s, telemetry); });

  const LoopStatistics loop = run_loop(flags.station.node.control_hz, [&](std::int64_t now_ns) {
    drain(states, arrived_states);
    drain(events, arrived_events);
    for (const EventMessage& event : arrived_events) {
      if (event.kind == EventMessage::Kind::kEngage) engage = true;
      if (event.kind == EventMessage::Kind::kDisengage) engage = false;
      if (event.kind == EventMessage::Kind::kSetBeta && event.value >= kSmallestBeta &&
          event.value <= kLargestBeta && event.value != wanted_beta.load()) {
        wanted_beta.store(event.value);
        contour.request_rebuild();
      }
    }
    GuidedContour* const task = contour.current();
    const MasterOutputs out = station.step(now_ns, task, engage, arrived_states, arrived_events);
    if (out.command) commands.write(*out.command);
    const bool engaged = out.mode == MasterMode::kEngaged;
    (engaged ? engaged_s : waited_s) += station.control_period_s();
    progress.mode.store(out.mode, std::memory_order_relaxed);
    progress.engaged_s.store(engaged_s, std::memory_order_relaxed);
    const MasterNode& node = station.node();
    if (node.tick() % kTelemetryTicks == 0) {
      progress.values.store(node.tick(),
                            master_values(out, task ? task->guide.beta : 1.0, node.link().clocks()));
    }
    const bool done = flags.duration_s > 0.0 && (engaged_s >= flags.duration_s || waited_s >= flags.wait_s);
    return !done && !stop_requested() && !contour.refused() && !machine.failed();
  });
  station.release();
  herald.request_stop();
  herald.join();

  if (contour.refused()) throw StartupError(contour.refusal());
  if (flags.duration_s > 0.0 && engaged_s < flags.duration_s && !stop_requested() && !machine.failed()) {
    throw StartupError(
        fmt::format("nobody to work with for {:.0f} s in cell '{}' of domain {}: are telekerf-vision and "
                    "telekerf-slave running there?",
                    flags.wait_s, bus_settings.cell, bus_settings.domain));
  }
  if (!flags.record.empty() && contour.current() != nullptr) {
    record_run(flags, station, contour, bus, emulator.get(), states.counters(), loop);
  }
  if (machine.failed()) throw StartupError(machine.failure());
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  flags.station.declare(settings);
  settings.add("record", flags.record, kFolder, "folder to record the run into");
  settings.add("engage", flags.engage, "let the slave follow as soon as everything is ready");
  settings.add("duration_s", flags.duration_s, {.min = 0, .max = 36000, .unit = "s"},
               "end after this long engaged, 0: run on");
  settings.add("wait_s", flags.wait_s, {.min = 1, .max = 3600, .unit = "s"},
               "with duration_s: give up after this long not engaged");
  flags.bus.declare(settings);
  flags.netem.declare(settings);
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
