// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/station.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "common/control/loop_design.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "slave/laser/dose_limits.h"
#include "slave/machining/tuning.h"

namespace telekerf::machining {
namespace {

constexpr double kHold_s = 0.1;       ///< a stopped tool is held until it stands
constexpr double kAtHome_m = 0.1e-3;  ///< the tool may be this far from where the job starts

JobSettings job_settings(const StationSettings& s, const robot::RobotModel& model) {
  JobSettings job;
  job.reach_m = model.workspace.radius_m;
  job.plan.control_hz = s.machining_hz;
  job.plan.speed_m_per_s = s.speed_mm_s * 1e-3;
  job.plan.keep_within(model.limits);
  job.plan.corner = s.corner;
  job.kerf_m = s.kerf_um * 1e-6;
  job.framing = !s.no_framing;
  job.select = s.select;
  return job;
}

/// `model` with the sensor that reads its joints.
JobExecutorSettings executor_settings(const StationSettings& settings, const TimedPathSettings& plan,
                                      const robot::RobotModel& model) {
  JobExecutorSettings out;
  out.follower.control_hz = settings.machining_hz;
  out.follower.loop_delay = model.drive_delay_s * settings.machining_hz;
  out.follower = tuned_for_speed(out.follower, model, plan.speed_m_per_s,
                                 plan.corner == CornerPolicy::kSlow ? kRippleAtCorners : kRipple);
  out.controller = settings.controller;
  out.laser_w = settings.laser_w;
  out.interlock = settings.interlock;
  return out;
}

std::size_t hold_ticks(const StationSettings& settings) {
  return static_cast<std::size_t>(kHold_s * settings.machining_hz);
}

}  // namespace

void StationSettings::add_parameters(Settings& settings) {
  settings.add("robot", robot, kRobot, "that machines: a shipped name or a file");
  machine.add_parameters(settings);
  beam.add_parameters(settings);
  settings.add("laser_w", laser_w, {.min = 0, .max = 1000, .unit = "W"}, "laser power");
  laser::add_dose_parameters(interlock, settings);
  settings.add("mismatch", mismatch, {.min = 0, .max = 0.5},
               "how far the simulated robot is off its file, as a fraction");
  settings.add("seed", seed, kSeeds, "of the simulated robot");
  settings.add("sensor", sensor, robot::kSensorKinds, "what reads the simulated robot's joints");
  settings.add("speed_mm_s", speed_mm_s, {.min = 0.1, .max = 100, .unit = "mm/s"}, "tangential speed");
  settings.add("controller", controller, kControllers, "how the robot is kept on the path");
  settings.add("corner", corner, kCorners, "what to do at corners");
  settings.add("material", material, workpiece::kMaterials, "what the beam meets");
  settings.add("kerf_um", kerf_um, {.min = 0, .max = 2000, .unit = "um"}, "width of the cut to compensate");
  settings.add("no_framing", no_framing, "no run round the work with the pilot beam");
  settings.add("select", select, 0, {.min = 0, .max = 9999},
               "A,B,..: these contours alone, by their numbers; 0 is the largest");
  settings.add("machining_hz", machining_hz, {.min = 800, .max = 10000, .unit = "Hz"}, "control rate");
}

void StationSettings::validate() const {
  beam.validate(laser_w);
  laser::require_dose(interlock, laser_w, speed_mm_s, "speed_mm_s");
}

Station::Station(const StationSettings& settings)
    : settings_(settings),
      model_(robot::load_robot(settings.robot)),
      jobs_(job_settings(settings, model_)),
      machine_(
          model_, settings.machine, settings.machining_hz,
          robot::open_drive(
              settings.machine.drive,
              {model_, settings.machining_hz, {settings.mismatch, settings.seed + 1000, settings.sensor}})),
      beam_(settings.beam, settings.laser_w, settings.machining_hz),
      monitor_(model_, settings.interlock.max_height_m),
      punctuality_(std::llround(1e9 / settings.machining_hz)),
      work_{.controller = std::string(kControllers.word(settings.controller)),
            .corner = std::string(kCorners.word(settings.corner)),
            .sensor = std::string(robot::kSensorKinds.word(settings.sensor)),
            .material = settings.material,
            .speed_m_per_s = settings.speed_mm_s * 1e-3,
            .drive = {settings.machine.drive, machine_.plant() != nullptr}} {
  settings.validate();
  control::require_short_delay(control::loop_conditions(model_, settings.machining_hz), "machining_hz");
}

std::unique_ptr<Job> Station::prepare(const ContourMessage& message) const {
  std::vector<geometry::Polyline> contours{{message.points_m, message.closed}};
  for (const ContourLine& line : message.further) contours.push_back({line.points_m, line.closed});
  auto job = make_job(contours, jobs_);
  if (!job) throw input_error("the contour cannot be machined: " + job.error());
  for (std::size_t i = 0; i < job->trajectory.size(); i += 8) {
    const Vec3 p = job->trajectory[i].position_m;
    if (p.head<2>().norm() > model_.workspace.radius_m * (1.0 + 1e-9)) {
      throw input_error(
          fmt::format("the work reaches {:.1f} mm from the workspace's centre, but {} reaches {:.1f} "
                      "mm; use a smaller --width-mm",
                      p.head<2>().norm() * 1e3, model_.name, model_.workspace.radius_m * 1e3));
    }
  }
  return std::make_unique<Job>(std::move(*job));
}

void Station::begin(const Job& job) {
  const robot::RobotSupervisor::InitialPose pose = machine_.wait_until_ready();
  if ((pose.tool_m - job.trajectory[0].position_m).norm() > kAtHome_m)
    from_here_ = approached_from(pose.tool_m, job, jobs_);
  job_ = from_here_ ? &*from_here_ : &job;
  robot::RobotModel read = model_;
  if (machine_.plant() != nullptr) read.sensor.kind = settings_.sensor;
  executor_.emplace(model_, *job_, executor_settings(settings_, jobs_.plan, read));
  executor_->reset(pose.joints_m);
  corridor_.emplace(job_->lines, settings_.interlock.corridor_m, model_.workspace.radius_m);
  work_.rows.reserve(job_->trajectory.size() + hold_ticks(settings_));
}

JobExecutorOutputs Station::step(std::int64_t now_ns, bool stop) noexcept {
  const auto true_tool_m = machine_.true_tool_m();
  const auto true_velocity = machine_.true_tool_velocity_m_per_s();
  const robot::JointReading reading = machine_.read();
  JobExecutorOutputs out = executor_->step(reading, stop,
                                           {.fault = machine_.failed() || beam_.failed(),
                                            .on_time = punctuality_.step(now_ns),
                                            .emission_agrees = beam_.emission_agrees(),
                                            .monitor_agrees = monitor_.agrees()});
  if (reading.valid) machine_.watch(out.tool_m);
  if (machine_.failed()) {
    out.laser_w = 0.0;
    out.pilot = false;
  }
  const double laser_w = beam_.emit(std::move(out.permit), out.time_ns, out.laser_w, out.pilot);
  monitor_.step(reading, &*corridor_, stop, laser_w > 0.0);
  machine_.write(out.currents_a);
  machine_.advance();
  const Vec3 velocity = true_velocity.value_or(out.tool_velocity_m_per_s);
  work_.rows.push_back({out.tick, true_tool_m.value_or(out.tool_m), velocity, laser_w});
  if (out.saturated || velocity.norm() > model_.limits.velocity_m_per_s) ++work_.limit_violations;
  if (stop) ++held_;
  const bool failed = machine_.failed() || beam_.failed() || !monitor_.agrees();
  ended_ = out.done || failed || held_ >= hold_ticks(settings_) || work_.rows.size() == work_.rows.capacity();
  work_.finished = out.done && !stop && !failed;
  return out;
}

void Station::release() noexcept {
  beam_.off();
  machine_.release();
}

nlohmann::ordered_json Station::report(const std::filesystem::path& folder,
                                       const LoopStatistics& loop) const {
  auto result = report_work(folder, *job_, work_);
  write_json(folder / "timing.json",
             nlohmann::ordered_json{{"time_s", static_cast<double>(loop.steps) / loop.rate_hz},
                                    {"rate_hz", loop.rate_hz},
                                    {"overruns", loop.overruns},
                                    {"late_steps", punctuality_.late_steps()},
                                    {"readings_missed", machine_.readings_missed()},
                                    {"laser_clipped", beam_.clipped()},
                                    {"laser_untold", beam_.write_failures()}});
  return result;
}

}  // namespace telekerf::machining
