// SPDX-License-Identifier: Apache-2.0
// telekerf-machine: machines the contours that vision publishes, without a master.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/contour_subscriber.h"
#include "common/bus/endpoints.h"
#include "common/bus/process.h"
#include "common/bus/stop_line.h"
#include "common/reporting/tables.h"
#include "common/runtime/program.h"
#include "common/runtime/real_time.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"
#include "slave/machining/run_recording.h"
#include "slave/machining/station.h"

namespace telekerf::machining {
namespace {

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  StationSettings station;
  StopFlags stop;
  RecordFlags record;
  std::string config;
  double wait_s = 20.0;  ///< for vision, then it gives up
  bool dry_run = false;
  void validate() const { station.validate(); }
};

const char* text_of(JobPhase phase) {
  switch (phase) {
    case JobPhase::kApproach:
      return "approaching";
    case JobPhase::kFraming:
      return "framing, pilot beam only";
    case JobPhase::kTravel:
      return "travelling, beam off";
    case JobPhase::kCut:
      return "cutting";
    case JobPhase::kReturn:
      return "returning";
  }
  return "unknown";
}

/// What would be done, in the order of the cuts.
void print_plan(const Job& job) {
  double reach_m = 0.0;
  for (std::size_t i = 0; i < job.trajectory.size(); ++i)
    reach_m = std::max(reach_m, job.trajectory[i].position_m.head<2>().norm());
  fmt::print("cut  contour  length_mm  kind\n");
  for (std::size_t i = 0; i < job.order.size(); ++i) {
    fmt::print("{:3}  {:7}  {:9.3f}  {}\n", i + 1, job.order[i], 1e3 * geometry::length_m(job.lines[i]),
               job.lines[i].closed ? "closed" : "open");
  }
  fmt::print("{:.1f} mm to cut, about {:.1f} s in all, reach {:.1f} mm; nothing was moved\n",
             1e3 * job.cut_length_m, job.time_s(), 1e3 * reach_m);
}

/// The job, or null if a stop came first. Throws StartupError.
const Job* awaited(ContourSubscriber<Job>& contour, Process& process, StopLine& emergency, double wait_s) {
  constexpr double kPatience_s = 0.5;  // vision is usually there by then
  const auto since = std::chrono::steady_clock::now();
  bool told = false;
  while (contour.current() == nullptr && !stop_requested() && !contour.refused()) {
    emergency.obeyed(emergency.order().number);  // nothing moves yet
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - since;
    if (!told && waited.count() > kPatience_s) {
      told = true;
      process.status().say("waiting for a contour from telekerf-vision in " + process.place());
    }
    if (waited.count() > wait_s) {
      throw environment_error(fmt::format("no contour for {:g} s in {}: is telekerf-vision running there?",
                                          wait_s, process.place()));
    }
  }
  if (contour.refused()) throw input_error(contour.refusal());
  return contour.current();
}

int run(Flags& flags) {
  flags.record.validate("result");
  flags.record.validate("machine");
  BusSettings settings = flags.bus.bus_settings(Site::kSlave, "slave");  // of which a cell has one
  if (settings.name.empty()) settings.name = "machine";
  const auto emulator = flags.netem.emulator(settings.site);
  settings.receive_filter = emulator;
  Station station(flags.station);

  Process process(settings, "machine");
  StatusReporter& status = process.status();
  netem::NetemSwitch netem_switch(process.bus(), emulator);
  StopLine emergency(process.bus(), flags.stop.path(settings));
  ContourSubscriber<Job> contour(process.bus(), [&](const ContourMessage& m) { return station.prepare(m); });
  if (station.machine().plant() == nullptr)
    status.say(flags.station.machine.drive + " is not simulated: the measured tool is recorded");
  process.ready();
  const Job* const job = awaited(contour, process, emergency, flags.wait_s);
  if (job == nullptr) return 1;
  const auto open =
      std::count_if(job->lines.begin(), job->lines.end(), [](const auto& line) { return !line.closed; });
  if (flags.station.kerf_um > 0.0 && open > 0) {
    status.say(fmt::format("warning: {} of {} contours are open, which --kerf-um does not move", open,
                           job->lines.size()));
  }
  for (const std::string& warning : job->warnings) status.say("warning: " + warning);
  if (flags.dry_run) {
    print_plan(*job);
    return 0;
  }
  RunIdentity identity = flags.netem.with_network(run_identity(settings, "telekerf-machine", flags.config));
  identity.role = "machine";  // on the bus it takes the slave's place
  RunRecording recording(flags.record, std::move(identity), station.control_hz(), status);
  recording.contours(contour.adopted());
  status.say(fmt::format("{} {} to cut, {:.1f} mm, about {:.1f} s in all", job->plans.size(),
                         job->plans.size() == 1 ? "contour" : "contours", job->cut_length_m * 1e3,
                         job->time_s()));
  for (const std::string& remark : real_time_remarks()) status.say(remark);
  station.begin(*job);

  bool stop = false;
  // A signal stops the tool first; the work ends when it stands.
  const LoopStatistics loop = run_loop(station.control_hz(), [&](std::int64_t now_ns) {
    const std::uint32_t number = emergency.order().number;
    stop = stop || number != 0 || stop_requested() || process.ended();
    emergency.obeyed(number);
    const JobExecutorOutputs out = station.step(now_ns, stop);
    recording.step(now_ns, out, station.last().tool_m, station.last().laser_w, stop);
    netem_switch.beam(station.last().laser_w > 0.0);
    status.state(text_of(out.phase));
    status.progress(out.progress, station.time_s());
    process.lookout().refused(Lookout::Device::kDrive, station.machine().refused());
    process.lookout().refused(Lookout::Device::kLaser, station.beam().refused());
    return !station.ended();
  });
  station.release();

  bool inside = true;
  Metrics figures;
  add_figures(loop, figures);
  recording.close(std::move(figures));
  if (flags.record.named()) {
    const auto result = station.report(flags.record.record, loop);
    inside = result["burn"]["energy_outside_corridor_j"].get<double>() == 0.0;
    fmt::print("{}", reporting::work_table(result));
  }
  if (station.machine().failed()) throw hardware_error(station.machine().failure());
  if (station.beam().failed()) throw hardware_error(station.beam().failure());
  if (!station.monitor_agrees()) {
    throw hardware_error(
        "the beam was on where the second judgement, by the raw readings of the joints, allows none, so it "
        "is off; "
        "is the robot's file right, and do its sensors count?");
  }
  process.refuse_ended();
  recording.refuse_unfinished();
  status.say(!inside ? "bad: the laser left the corridor" : station.finished() ? "finished" : "stopped");
  return station.finished() && inside ? 0 : 1;
}

void add_parameters(Flags& flags, Settings& settings) {
  flags.station.add_parameters(settings);
  flags.stop.add_parameters(settings);
  flags.record.add_parameters(settings);
  settings.add("wait_s", flags.wait_s, {.min = 1, .max = 3600, .unit = "s"},
               "gives up after this long without a contour");
  settings.add("dry_run", flags.dry_run, "prints the cuts, their time and reach; nothing moves");
  flags.bus.add_parameters(settings);
  flags.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf::machining

int main(int argc, char** argv) {
  using namespace telekerf::machining;
  return telekerf::run_program(
      argc, argv, "telekerf-machine",
      "The robot with the laser: machines the contours that vision publishes, without a master", Flags{},
      add_parameters, run);
}
