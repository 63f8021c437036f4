// SPDX-License-Identifier: Apache-2.0
#include "slave/automatic/process.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <vector>

#include "common/bus/contour_watch.h"
#include "common/bus/endpoints.h"
#include "common/robot/simulated_robot.h"
#include "common/runtime/loop.h"
#include "common/runtime/refusal.h"
#include "slave/automatic/machinist.h"
#include "slave/laser/kerf.h"

namespace telekerf::slave {
namespace {

constexpr double kControlHz = 2400.0;

struct Work {
  geometry::Polyline contour;
  geometry::NearestIndex corridor;
  Job job;
};

struct Row {
  Vec3 reference_m, tool_m;  ///< tool: the truth
  double laser_w;
};

JobSettings job_settings(const AutomaticSettings& s) {
  JobSettings job;
  job.plan.control_hz = kControlHz;
  job.plan.speed_m_per_s = s.speed_mm_s * 1e-3;
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

std::unique_ptr<Work> prepare(const ContourMessage& message, const robot::RobotModel& model,
                              const JobSettings& settings) {
  geometry::Polyline contour{message.points_m, message.closed};
  auto job = make_job({contour}, settings);
  if (!job) throw Refusal("the contour cannot be machined: " + job.error());
  for (std::size_t i = 0; i < job->track.size(); i += 8) {
    const Vec3 p = job->track[i].position_m;
    if (p.head<2>().norm() > model.workspace.radius_m) {
      throw Refusal(
          fmt::format("the work reaches {:.1f} mm from the workspace's centre, but {} reaches {:.1f} "
                      "mm; use a smaller --width-mm",
                      p.head<2>().norm() * 1e3, model.name, model.workspace.radius_m * 1e3));
    }
  }
  fmt::print("slave: {:.1f} mm to cut, about {:.1f} s in all\n", job->cut_length_m * 1e3, job->time_s());
  std::fflush(stdout);
  return std::make_unique<Work>(Work{contour, geometry::NearestIndex(contour), std::move(*job)});
}

void report(const std::filesystem::path& folder, const Work& work, const std::vector<Row>& rows,
            const AutomaticSettings& settings, bool finished, double time_s, const LoopStatistics& loop) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  const geometry::Box box = geometry::bounding_box(work.contour.points_m);
  const PulsedSourceSettings source;
  HeightMap map({.centre_m = box.centre(), .half_width_m = 0.5 * box.size().maxCoeff() + 0.5e-3},
                material(settings.material), source);
  std::ofstream trace(folder / "trace.csv");
  trace << "t_s,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w\n";
  double squares = 0.0, worst = 0.0;
  std::size_t lit = 0;
  geometry::Polyline path{{}, work.contour.closed};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    trace << fmt::format("{:.7f},{:.12f},{:.12f},{:.12f},{:.12f},{:.12f},{:.6g}\n",
                         static_cast<double>(i) / kControlHz, row.reference_m.x(), row.reference_m.y(),
                         row.tool_m.x(), row.tool_m.y(), row.tool_m.z(), row.laser_w);
    if (!(row.laser_w > 0.0) || i + 1 == rows.size()) continue;
    map.expose(row.tool_m.head<2>(), rows[i + 1].tool_m.head<2>(), row.laser_w, 1.0 / kControlHz, 0.0,
               &work.corridor);
    const double error = work.corridor.find(row.tool_m.head<2>()).distance_m;
    squares += error * error;
    worst = std::max(worst, error);
    ++lit;
    path.points_m.push_back(row.tool_m.head<2>());
  }
  const MarkAlongPath mark =
      path.size() > 2 ? measure_mark(map, path, source.spot_radius_m) : MarkAlongPath{};
  const nlohmann::ordered_json result{
      {"finished", finished},
      {"controller", settings.controller},
      {"corner", settings.corner},
      {"speed_mm_s", settings.speed_mm_s},
      {"length_mm", work.job.cut_length_m * 1e3},
      {"contour_error_um",
       {{"rms", lit == 0 ? 0.0 : 1e6 * std::sqrt(squares / static_cast<double>(lit))}, {"max", 1e6 * worst}}},
      {"time_s", time_s},
      {"time_estimate_s", work.job.time_s()},
      {"burn",
       {{"material", settings.material},
        {"depth_um", mark.depth_m * 1e6},
        {"kerf_um", mark.kerf_m * 1e6},
        {"energy_inside_j", map.energy().inside_j},
        {"energy_outside_corridor_j", map.energy().outside_j}}},
      {"loop", {{"rate_hz", loop.rate_hz}, {"overruns", loop.overruns}}}};
  std::ofstream json(folder / "result.json");
  json << result.dump(2) << "\n";
  if (!json.flush() || !trace.flush() || !cv::imwrite((folder / "mark.png").string(), map.picture()) ||
      !cv::imwrite((folder / "depth.png").string(), map.depth_picture())) {
    throw Refusal(fmt::format("{}: cannot be written", folder.string()));
  }
  fmt::print("{}\n", result.dump(2));
}

}  // namespace

void AutomaticSettings::declare(Settings& settings) {
  settings.add("speed_mm_s", speed_mm_s, {.min = 0.1, .max = 100}, "automatic: tangential speed");
  settings.add("controller", controller, "automatic: law", {"auto", "independent", "preview", "contouring"});
  settings.add("corner", corner, "automatic: what to do at corners", {"exact", "rounded", "slow"});
  settings.add("material", material, "automatic: what the beam meets", material_names());
  settings.add("kerf_um", kerf_um, {.min = 0, .max = 2000}, "automatic: width of the cut to compensate");
  settings.add("no_framing", no_framing, "automatic: no run round the work with the pilot beam");
}

int run_automatic(const BusSettings& bus_settings, const AutomaticSettings& settings,
                  const AutomaticRobot& options, const std::string& folder) {
  const robot::RobotModel model = robot::load_robot(options.robot);
  robot::SimulatedRobot plant(robot::mismatched(model, options.mismatch, options.seed + 1000),
                              options.seed + 1000, model.in_base(Vec3::Zero()));
  const JobSettings jobs = job_settings(settings);
  catch_stop_signals();
  Bus bus(bus_settings);
  Reader<EventMessage> events(bus);
  ContourWatch<Work> contour(bus, [&](const ContourMessage& m) { return prepare(m, model, jobs); });
  fmt::print("slave: ready in {}, automatic\n", bus_settings.cell);
  std::fflush(stdout);
  while (contour.current() == nullptr && !stop_requested() && !contour.refused()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (contour.refused()) throw Refusal(contour.refusal());
  if (contour.current() == nullptr) return 1;
  const Work& work = *contour.current();

  MachinistSettings machinist_settings;
  machinist_settings.follower.quiet_for(jobs.plan.speed_m_per_s, jobs.plan.corner == CornerPolicy::kSlow);
  machinist_settings.controller = kind_of(settings.controller);
  machinist_settings.laser_w = options.laser_w;
  Machinist machinist(model, work.job, work.corridor, work.contour.closed, machinist_settings);
  machinist.reset(plant.read().joints_m);

  std::vector<Row> rows;
  rows.reserve(work.job.track.size() + 1);
  std::atomic<int> phase{-1};
  std::atomic<double> progress{0.0};
  std::jthread herald([&](const std::stop_token& stop) {
    int said = -1, tenth = 0;
    for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      if (const int now = phase.load(); now != said) {
        said = now;
        fmt::print("slave: {}\n", name_of(static_cast<JobPhase>(now)));
      }
      if (const int now = static_cast<int>(10.0 * progress.load()); now > tenth) {
        tenth = now;
        fmt::print("slave: {} %, {:.0f} s to go\n", 10 * now, (1.0 - progress.load()) * work.job.time_s());
      }
      std::fflush(stdout);
    }
  });

  bool stop = false, done = false;
  std::int64_t first_ns = 0, last_ns = 0;
  const LoopStatistics loop = run_loop(kControlHz, [&](std::int64_t now_ns) {
    if (first_ns == 0) first_ns = now_ns;
    last_ns = now_ns;
    while (const auto event = events.take()) stop = stop || event->value.kind == EventMessage::Kind::kStop;
    const Vec3 tool = model.in_workpiece(plant.true_tool_in_base_m());
    const MachinistOutputs out = machinist.step(plant.read(), stop);
    plant.write(out.currents_a);
    plant.advance(1.0 / kControlHz);
    if (rows.size() < rows.capacity()) rows.push_back({out.reference_m, tool, out.laser_w});
    phase.store(static_cast<int>(out.phase), std::memory_order_relaxed);
    progress.store(out.progress, std::memory_order_relaxed);
    done = out.done;
    return !done && !stop && !stop_requested();
  });
  const double time_s = static_cast<double>(last_ns - first_ns) * 1e-9;
  herald.request_stop();
  herald.join();
  fmt::print("slave: {}\n", done ? "finished" : "stopped");
  if (!folder.empty()) report(folder, work, rows, settings, done, time_s, loop);
  return done ? 0 : 1;
}

}  // namespace telekerf::slave
