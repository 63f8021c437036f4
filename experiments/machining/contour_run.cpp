// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_run.h"

#include <fmt/format.h>

#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"
#include "slave/machining/tool_trace.h"
#include "slave/machining/tuning.h"

namespace telekerf::experiments {
namespace {

using machining::Reference;

/// Held at the start until the observer knows the weight.
constexpr double kHold_s = 1.5;

}  // namespace

robot::RobotModel true_robot(const robot::RobotModel& nominal, const ContourRunSettings& settings) {
  if (settings.ideal) {
    robot::RobotModel model = nominal;
    model.friction = {};
    model.sensor = {};
    model.sensor.resolution_m = 0.0;
    return model;
  }
  robot::RobotModel model = robot::mismatched(nominal, settings.mismatch, settings.seed + 1000);
  model.sensor.kind = robot::Sensor::Kind::kHall;
  if (settings.perfect_sensor) {
    model.sensor = {};
    model.sensor.resolution_m = 0.0;
  }
  return model;
}

machining::PathFollowerSettings tuned_follower(robot::RobotModel nominal,
                                               const ContourRunSettings& settings) {
  nominal.sensor.kind = robot::Sensor::Kind::kHall;
  const bool slow = settings.plan.corner == machining::CornerPolicy::kSlow;
  return machining::tuned_for_speed(settings.follower, nominal, settings.plan.speed_m_per_s,
                                    slow ? machining::kRippleAtCorners : machining::kRipple);
}

ContourRun run_contour(const machining::TimedPath& plan, const geometry::Polyline& contour,
                       const ContourRunSettings& settings) {
  robot::RobotModel nominal = robot::load_robot(settings.robot);
  if (settings.ideal) nominal = true_robot(nominal, settings);
  const machining::Trajectory& trajectory = plan.trajectory;
  for (std::size_t i = 0; i < trajectory.size(); i += 16) {
    const Vec3 p = trajectory[i].position_m;
    if (p.head<2>().norm() > nominal.workspace.radius_m ||
        std::abs(p.z()) > 0.5 * nominal.workspace.height_m) {
      throw input_error(fmt::format(
          "the path reaches ({:.1f}, {:.1f}, {:.1f}) mm, outside the workspace of {} "
          "({:.1f} mm about the centre, {:.1f} mm up and down); use a smaller --width-mm or --radius-mm",
          p.x() * 1e3, p.y() * 1e3, p.z() * 1e3, nominal.name, nominal.workspace.radius_m * 1e3,
          0.5e3 * nominal.workspace.height_m));
    }
  }
  const bool closed = plan.path.closed();
  robot::SimulatedRobot robot(true_robot(nominal, settings), settings.seed + 1000,
                              nominal.in_base(trajectory[0].position_m));
  machining::PathFollower follower(nominal, machining::joint_settings(settings.controller, settings.follower),
                                   machining::make_controller(settings.controller, closed, settings.follower),
                                   machining::model_use(settings.controller, settings.follower));
  follower.reset(robot.read().joints_m);

  ContourRun run;
  run.pass = {&plan, &contour, {}};
  const auto hold = static_cast<std::size_t>(kHold_s / plan.period_s);
  std::vector<Vec3> on_the_way(static_cast<std::size_t>(settings.follower.loop_delay), Vec3::Zero());
  std::size_t next = 0;
  for (std::size_t i = 0; i < hold + trajectory.size(); ++i) {
    const std::size_t tick = i < hold ? 0 : i - hold;
    const Reference& reference = trajectory[tick];
    if (i >= hold && reference.beam) {
      const machining::PassRow row =
          machining::pass_row(reference, nominal.in_workpiece(robot.true_tool_in_base_m()),
                              robot.true_tool_velocity_m_per_s(), 0.0);
      run.pass.rows.push_back(row);
      const auto& q = robot.true_state().joints_m;
      const bool off_stroke =
          q.minCoeff() < nominal.geometry.stroke_min_m || q.maxCoeff() > nominal.geometry.stroke_max_m;
      if (off_stroke || row.tool_velocity_m_per_s.norm() > nominal.limits.velocity_m_per_s ||
          reference.acceleration_m_per_s2.norm() > nominal.limits.acceleration_m_per_s2) {
        ++run.limit_violations;
      }
    }
    Vec3 currents = follower.step(robot.read(), trajectory, static_cast<double>(tick));
    if (i >= hold && follower.joints().saturated()) ++run.limit_violations;
    if (i >= hold && reference.beam)
      run.pass.rows.back().laser_w = settings.laser_w * follower.beam_power(reference);
    if (!on_the_way.empty()) {
      std::swap(currents, on_the_way[next]);
      next = (next + 1) % on_the_way.size();
    }
    robot.write(currents);
    robot.advance(plan.period_s);
  }
  if (robot.broken())
    throw configuration_error("the robot left the poses that it can take: the controller is unstable");
  run.time_s = static_cast<double>(trajectory.size()) * plan.period_s;
  return run;
}

nlohmann::ordered_json measure(const ContourRun& run, const ContourRunSettings& settings) {
  const machining::TimedPath& plan = *run.pass.plan;
  nlohmann::ordered_json out = machining::measure({&run.pass, 1}, settings.plan.speed_m_per_s);
  out["limit_violations"] = run.limit_violations;
  out["time_s"] = run.time_s;
  out["time_estimate_s"] = plan.time_s();
  out["smoothing_um"] = plan.path.smoothing_m() * 1e6;
  out["harmonics"] = plan.path.harmonics();
  return out;
}

void write_contour_trace(const ContourRun& run, const std::filesystem::path& csv) {
  machining::write_tool_trace(csv, run.pass.plan->period_s, run.pass.rows.size(), [&](std::size_t i) {
    const machining::PassRow& row = run.pass.rows[i];
    return machining::ToolTraceRow{row.reference.position_m, row.tool_m, row.laser_w};
  });
}

}  // namespace telekerf::experiments
