// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/process.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "common/bus/contour_subscriber.h"
#include "common/bus/endpoints.h"
#include "common/runtime/loop.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "slave/laser/material.h"
#include "slave/machining/job_executor.h"
#include "slave/machining/work_report.h"

namespace telekerf::machining {
namespace {

constexpr double kHold_s = 0.1;
constexpr double kPatience_s = 0.5;   ///< vision is usually there by then
constexpr double kAtHome_m = 0.1e-3;  ///< the tool may be this far from where the job starts

JobSettings job_settings(const AutomaticSettings& s, const robot::RobotModel& model) {
  JobSettings job;
  job.reach_m = model.workspace.radius_m;
  job.plan.control_hz = s.machining_hz;
  job.plan.speed_m_per_s = s.speed_mm_s * 1e-3;
  job.plan.keep_within(model.limits);
  job.plan.corner = s.corner == "exact"  ? CornerPolicy::kExact
                    : s.corner == "slow" ? CornerPolicy::kSlow
                                         : CornerPolicy::kRounded;
  job.kerf_m = s.kerf_um * 1e-6;
  job.framing = !s.no_framing;
  return job;
}

ControllerKind kind_of(const std::string& name) {
  if (name == "independent") return ControllerKind::kIndependent;
  if (name == "preview") return ControllerKind::kPreview;
  if (name == "contouring") return ControllerKind::kContouring;
  return ControllerKind::kAuto;
}

const char* name_of(JobPhase phase) {
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

std::unique_ptr<Job> prepare(const ContourMessage& message, const robot::RobotModel& model,
                             const JobSettings& settings) {
  std::vector<geometry::Polyline> contours{{message.points_m, message.closed}};
  for (const ContourLine& line : message.further) contours.push_back({line.points_m, line.closed});
  auto job = make_job(contours, settings);
  if (!job) throw StartupError("the contour cannot be machined: " + job.error());
  for (std::size_t i = 0; i < job->trajectory.size(); i += 8) {
    const Vec3 p = job->trajectory[i].position_m;
    if (p.head<2>().norm() > model.workspace.radius_m * (1.0 + 1e-9)) {
      throw StartupError(
          fmt::format("the work reaches {:.1f} mm from the workspace's centre, but {} reaches {:.1f} "
                      "mm; use a smaller --width-mm",
                      p.head<2>().norm() * 1e3, model.name, model.workspace.radius_m * 1e3));
    }
  }
  fmt::print("slave: {} to cut, {:.1f} mm, about {:.1f} s in all\n",
             contours.size() == 1 ? "1 contour" : fmt::format("{} contours", contours.size()),
             job->cut_length_m * 1e3, job->time_s());
  std::fflush(stdout);
  return std::make_unique<Job>(std::move(*job));
}

/// Says what the work has come to, from a thread of its own: the loop does not write.
class Herald {
 public:
  explicit Herald(double time_s)
      : time_s_(time_s), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void tell(JobPhase phase, double progress) noexcept {
    phase_.store(static_cast<int>(phase), std::memory_order_relaxed);
    progress_.store(progress, std::memory_order_relaxed);
  }

 private:
  void run(const std::stop_token& stop) {
    int said = kNothing, tenth = 0;
    for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      if (const int now = phase_.load(); now != said) {
        said = now;
        fmt::print("slave: {}\n", name_of(static_cast<JobPhase>(now)));
      }
      if (const int now = static_cast<int>(10.0 * progress_.load()); now > tenth) {
        tenth = now;
        fmt::print("slave: {} %, {:.0f} s to go\n", 10 * now, (1.0 - progress_.load()) * time_s_);
      }
      std::fflush(stdout);
    }
  }

  static constexpr int kNothing = -1;
  double time_s_;
  std::atomic<int> phase_{kNothing};
  std::atomic<double> progress_{0.0};
  std::jthread thread_;  ///< last: ends first
};

/// The job, or null if a stop came first. Throws StartupError.
const Job* awaited(ContourSubscriber<Job>& contour, const BusSettings& bus, double wait_s) {
  const auto since = std::chrono::steady_clock::now();
  bool told = false;
  while (contour.current() == nullptr && !stop_requested() && !contour.refused()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - since;
    if (!told && waited.count() > kPatience_s) {
      told = true;
      fmt::print("slave: waiting for a contour from telekerf-vision in cell '{}' of domain {}\n", bus.cell,
                 bus.domain);
      std::fflush(stdout);
    }
    if (waited.count() > wait_s) {
      throw StartupError(
          fmt::format("no contour for {:g} s in cell '{}' of domain {}: is telekerf-vision running there?",
                      wait_s, bus.cell, bus.domain));
    }
  }
  if (contour.refused()) throw StartupError(contour.refusal());
  return contour.current();
}

JobExecutorSettings executor_settings(const AutomaticSettings& settings, const TimedPathSettings& plan,
                                      double laser_w) {
  JobExecutorSettings out;
  out.follower.control_hz = settings.machining_hz;
  out.follower.tune_for_speed(plan.speed_m_per_s, plan.corner == CornerPolicy::kSlow);
  out.controller = kind_of(settings.controller);
  out.laser_w = laser_w;
  return out;
}

}  // namespace

void AutomaticSettings::declare(Settings& settings) {
  settings.add("speed_mm_s", speed_mm_s, {.min = 0.1, .max = 100, .unit = "mm/s"},
               "automatic: tangential speed");
  settings.add("controller", controller, "automatic: law", {"auto", "independent", "preview", "contouring"});
  settings.add("corner", corner, "automatic: what to do at corners", {"exact", "rounded", "slow"});
  settings.add("material", material, "automatic: what the beam meets", laser::material_names());
  settings.add("sensor", sensor, "automatic: what reads the joints", {"hall", "encoder"});
  settings.add("kerf_um", kerf_um, {.min = 0, .max = 2000, .unit = "um"},
               "automatic: width of the cut to compensate");
  settings.add("no_framing", no_framing, "automatic: no run round the work with the pilot beam");
  settings.add("machining_hz", machining_hz, {.min = 800, .max = 10000, .unit = "Hz"},
               "automatic: control rate");
  settings.add("wait_s", wait_s, {.min = 1, .max = 3600, .unit = "s"},
               "automatic: give up after this long without a contour");
}

int run_automatic(const BusSettings& bus_settings, const AutomaticSettings& settings,
                  const AutomaticRobot& options, const std::string& folder) {
  const robot::RobotModel model = robot::load_robot(options.robot);
  using Sensor = robot::Sensor::Kind;
  robot::RobotSupervisor machine(
      model, options.machine, settings.machining_hz,
      robot::open_drive(options.machine.drive,
                        {model,
                         settings.machining_hz,
                         {options.mismatch, options.seed + 1000,
                          settings.sensor == "hall" ? Sensor::kHall : Sensor::kEncoder}}));
  laser::LaserOutput beam(options.beam, options.laser_w, settings.machining_hz);
  WorkRecord work{.controller = settings.controller,
                  .corner = settings.corner,
                  .sensor = settings.sensor,
                  .material = settings.material,
                  .speed_m_per_s = settings.speed_mm_s * 1e-3,
                  .drive = {options.machine.drive, machine.plant() != nullptr}};
  if (!work.drive.true_tool)
    fmt::print("slave: {} is not simulated: what is recorded is the measured tool\n", work.drive.name);
  const JobSettings jobs = job_settings(settings, model);
  catch_stop_signals();
  Bus bus(bus_settings);
  Reader<EventMessage> events(bus);
  ContourSubscriber<Job> contour(bus, [&](const ContourMessage& m) { return prepare(m, model, jobs); });
  fmt::print("slave: ready in {}, automatic\n", bus_settings.cell);
  std::fflush(stdout);
  const Job* const published = awaited(contour, bus_settings, settings.wait_s);
  if (published == nullptr) return 1;
  if (!folder.empty()) make_folder("--record", folder);
  const robot::RobotSupervisor::InitialPose initial = machine.wait_until_ready();
  std::optional<Job> from_there;
  if ((initial.tool_m - published->trajectory[0].position_m).norm() > kAtHome_m)
    from_there = approached_from(initial.tool_m, *published, jobs);
  const Job& job = from_there ? *from_there : *published;

  JobExecutor executor(model, job, executor_settings(settings, jobs.plan, options.laser_w));
  executor.reset(initial.joints_m);
  const auto hold_ticks = static_cast<std::size_t>(kHold_s * settings.machining_hz);
  work.rows.reserve(job.trajectory.size() + hold_ticks);
  std::optional<Herald> herald(std::in_place, job.time_s());
  bool stop = false, done = false;
  std::size_t held = 0;
  std::int64_t first_ns = 0, last_ns = 0;
  const LoopStatistics loop = run_loop(settings.machining_hz, [&](std::int64_t now_ns) {
    if (first_ns == 0) first_ns = now_ns;
    last_ns = now_ns;
    while (const auto event = events.take()) stop = stop || event->value.kind == EventMessage::Kind::kStop;
    stop = stop || stop_requested();
    const auto true_tool_m = machine.true_tool_m();
    const auto true_velocity = machine.true_tool_velocity_m_per_s();
    const JobExecutorOutputs out = executor.step(machine.read(), stop);
    const double laser_w = beam.emit(out.laser_w, out.pilot);
    machine.write(out.currents_a);
    machine.advance();
    const Vec3 velocity = true_velocity.value_or(out.tool_velocity_m_per_s);
    work.rows.push_back({out.tick, true_tool_m.value_or(out.tool_m), velocity, laser_w});
    if (out.saturated || velocity.norm() > model.limits.velocity_m_per_s) ++work.limit_violations;
    herald->tell(out.phase, out.progress);
    done = out.done;
    // A stopped tool is held until it stands.
    if (stop) ++held;
    return !done && !machine.failed() && !beam.failed() && held < hold_ticks &&
           work.rows.size() < work.rows.capacity();
  });
  beam.off();
  machine.release();
  herald.reset();
  work.finished = done && !stop && !machine.failed() && !beam.failed();
  fmt::print("slave: {}\n", work.finished ? "finished" : "stopped");
  bool inside = true;
  if (!folder.empty()) {
    const auto result = report_work(folder, job, work);
    inside = result["burn"]["energy_outside_corridor_j"].get<double>() == 0.0;
    write_json(std::filesystem::path(folder) / "timing.json",
               nlohmann::ordered_json{{"time_s", static_cast<double>(last_ns - first_ns) * 1e-9},
                                      {"rate_hz", loop.rate_hz},
                                      {"overruns", loop.overruns},
                                      {"readings_missed", machine.readings_missed()},
                                      {"laser_clipped", beam.clipped()},
                                      {"laser_untold", beam.write_failures()}});
    fmt::print("{}\n", json_text(result));
  }
  if (machine.failed()) throw StartupError(machine.failure());
  if (beam.failed()) throw StartupError(beam.failure());
  if (!inside) fmt::print("slave: bad: the laser left the corridor\n");
  return work.finished && inside ? 0 : 1;
}

}  // namespace telekerf::machining
