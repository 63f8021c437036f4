// SPDX-License-Identifier: Apache-2.0
#include "tests/experiments/contour_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "common/geometry/nearest.h"
#include "common/robot/simulated_robot.h"
#include "common/runtime/refusal.h"

namespace telekerf::experiments {
namespace {

using geometry::NearestIndex;
using geometry::Polyline;
using slave::Reference;

/// Held at the start until the observer knows the weight.
constexpr double kHold_s = 1.5;
/// Nearer than this to a corner, measures are the corner's.
constexpr double kCornerReach_m = 0.4e-3;
constexpr double kCornerTurn_rad = std::numbers::pi / 6;
constexpr double kCornerWindow_m = 0.15e-3;

struct Spread {
  double squares = 0.0;
  double max = 0.0;
  std::size_t count = 0;
  void add(double v) {
    squares += v * v;
    max = std::max(max, std::abs(v));
    ++count;
  }
  double rms() const { return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count)); }
  nlohmann::ordered_json um() const { return {{"rms", rms() * 1e6}, {"max", max * 1e6}}; }
};

bool near_any(const std::vector<Vec2>& places, const Vec2& p, double reach_m) {
  return std::any_of(places.begin(), places.end(),
                     [&](const Vec2& c) { return (c - p).squaredNorm() < reach_m * reach_m; });
}

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
  return model;
}

ContourRun run_contour(const slave::Plan& plan, const ContourRunSettings& settings) {
  robot::RobotModel nominal = robot::load_robot(settings.robot);
  if (settings.ideal) nominal = true_robot(nominal, settings);
  const slave::Track& track = plan.track;
  for (std::size_t i = 0; i < track.size(); i += 16) {
    const Vec3 p = track[i].position_m;
    if (p.head<2>().norm() > nominal.workspace.radius_m ||
        std::abs(p.z()) > 0.5 * nominal.workspace.height_m) {
      throw Refusal(
          fmt::format("the path reaches ({:.1f}, {:.1f}, {:.1f}) mm, outside the workspace of {} "
                      "({:.1f} mm about the centre); use a smaller --width-mm",
                      p.x() * 1e3, p.y() * 1e3, p.z() * 1e3, nominal.name, nominal.workspace.radius_m * 1e3));
    }
  }
  const bool closed = plan.path.closed();
  robot::SimulatedRobot robot(true_robot(nominal, settings), settings.seed + 1000,
                              nominal.in_base(track[0].position_m));
  slave::Follower follower(nominal, slave::drive_settings(settings.controller, closed, settings.follower),
                           slave::make_controller(settings.controller, closed, settings.follower),
                           settings.follower.model_ahead);
  follower.reset(robot.read().joints_m);

  ContourRun run;
  const auto hold = static_cast<std::size_t>(kHold_s / plan.period_s);
  std::vector<Vec3> on_the_way(static_cast<std::size_t>(settings.follower.loop_delay), Vec3::Zero());
  std::size_t next = 0;
  for (std::size_t i = 0; i < hold + track.size(); ++i) {
    const std::size_t tick = i < hold ? 0 : i - hold;
    const Reference& reference = track[tick];
    if (i >= hold && reference.beam) {
      ContourRow row;
      row.t_s = static_cast<double>(run.rows.size()) * plan.period_s;
      row.reference = reference;
      row.tool_m = nominal.in_workpiece(robot.true_tool_in_base_m());
      row.tool_velocity_m_per_s = robot.true_tool_velocity_m_per_s();
      row.error_in_frame_m = slave::moving_frame(reference).rows * (reference.position_m - row.tool_m);
      run.rows.push_back(row);
      const auto& q = robot.true_state().joints_m;
      const bool off_stroke =
          q.minCoeff() < nominal.geometry.stroke_min_m || q.maxCoeff() > nominal.geometry.stroke_max_m;
      if (off_stroke || row.tool_velocity_m_per_s.norm() > nominal.limits.velocity_m_per_s ||
          reference.acceleration_m_per_s2.norm() > nominal.limits.acceleration_m_per_s2) {
        ++run.limit_violations;
      }
    }
    Vec3 currents = follower.step(robot.read(), track, static_cast<double>(tick));
    if (i >= hold && follower.drive().saturated()) ++run.limit_violations;
    if (i >= hold && reference.beam)
      run.rows.back().laser_w = settings.laser_w * follower.beam_power(reference);
    if (!on_the_way.empty()) {
      std::swap(currents, on_the_way[next]);
      next = (next + 1) % on_the_way.size();
    }
    robot.write(currents);
    robot.advance(plan.period_s);
  }
  if (robot.broken()) throw Refusal("the robot left the poses that it can take: the controller is unstable");
  run.time_s = static_cast<double>(track.size()) * plan.period_s;
  return run;
}

std::vector<Vec2> corners_of(const Polyline& contour) {
  const NearestIndex index(contour);
  const double length = index.length_m();
  const double step = 20e-6;
  const auto count = static_cast<std::size_t>(length / step);
  const auto turn_at = [&](double s) {
    const double w = kCornerWindow_m;
    if (!contour.closed && (s < 2 * w || s > length - 2 * w)) return 0.0;
    const Vec2 a = index.at(s - w).point_m - index.at(s - 2 * w).point_m;
    const Vec2 b = index.at(s + 2 * w).point_m - index.at(s + w).point_m;
    return std::abs(std::atan2(geometry::cross(a, b), a.dot(b)));
  };
  std::vector<double> turn(count);
  for (std::size_t i = 0; i < count; ++i) turn[i] = turn_at(static_cast<double>(i) * step);
  // One corner a run of sharp places: in its middle.
  std::vector<Vec2> corners;
  for (std::size_t i = 0; i < count; ++i) {
    if (turn[i] < kCornerTurn_rad) continue;
    std::size_t end = i;
    while (end + 1 < count && turn[end + 1] >= kCornerTurn_rad) ++end;
    const Vec2 place = index.at(0.5 * static_cast<double>(i + end) * step).point_m;
    // A smooth bend turns all the way: a corner does so within its window.
    const bool known = near_any(corners, place, 2 * kCornerWindow_m);  // around the start twice
    if (!known && static_cast<double>(end - i) * step < 6 * kCornerWindow_m) corners.push_back(place);
    i = end;
  }
  return corners;
}

nlohmann::ordered_json measure(const ContourRun& run, const slave::Plan& plan, const Polyline& contour,
                               const ContourRunSettings& settings) {
  const NearestIndex extracted(contour);
  Polyline reference_line;
  Polyline tool_line;
  for (const auto& row : run.rows) {
    reference_line.points_m.push_back(row.reference.position_m.head<2>());
    tool_line.points_m.push_back(row.tool_m.head<2>());
  }
  const NearestIndex reference(reference_line);
  const NearestIndex tool(tool_line);
  const std::vector<Vec2> corners = corners_of(contour);

  Spread to_contour, to_reference, normal, tangential, height, model, model_everywhere, ripple;
  double speed_sum = 0.0;
  std::vector<double> speeds;
  for (const auto& row : run.rows) {
    const Vec2 p = row.tool_m.head<2>();
    to_contour.add(extracted.find(p).distance_m);
    to_reference.add(reference.find(p).distance_m);
    tangential.add(row.error_in_frame_m[0]);
    normal.add(row.error_in_frame_m[1]);
    height.add(row.error_in_frame_m[2]);
    const double speed = row.tool_velocity_m_per_s.dot(row.reference.tangent);
    speed_sum += speed;
    const Vec2 at = row.reference.position_m.head<2>();
    const double off = extracted.find(at).distance_m;
    model_everywhere.add(off);
    if (near_any(corners, at, kCornerReach_m)) continue;
    model.add(off);
    speeds.push_back(speed - row.reference.speed_m_per_s);
  }
  const double mean = speed_sum / static_cast<double>(run.rows.size());
  for (const double deviation : speeds) ripple.add(deviation);
  double corner_error = 0.0;
  for (const Vec2& corner : corners) corner_error = std::max(corner_error, tool.find(corner).distance_m);

  double gap = 0.0;
  if (contour.closed) {
    // How far the second pass over the start runs from where the first one began.
    Polyline after;
    for (const auto& row : run.rows) {
      if (row.reference.arc_length_m > 0.5 * plan.path.length_m())
        after.points_m.push_back(row.tool_m.head<2>());
    }
    gap = NearestIndex(after).find(run.rows.front().tool_m.head<2>()).distance_m;
  }

  nlohmann::ordered_json out;
  out["contour_error_um"] = to_contour.um();
  out["reference_error_um"] = to_reference.um();
  out["normal_error_um"] = normal.um();
  out["tangential_error_um"] = tangential.um();
  out["height_error_um"] = height.um();
  out["model_error_um"] = {
      {"rms", model.rms() * 1e6}, {"max", model.max * 1e6}, {"max_at_corners", model_everywhere.max * 1e6}};
  out["tangential_speed"] = {{"commanded_mm_s", settings.plan.speed_m_per_s * 1e3},
                             {"mean_mm_s", mean * 1e3},
                             {"ripple_percent", 100.0 * ripple.rms() / mean},
                             {"ripple_peak_percent", 100.0 * ripple.max / mean},
                             {"slowest_planned_mm_s", plan.slowest_m_per_s * 1e3}};
  out["corners"] = corners.size();
  out["corner_error_um"] = corner_error * 1e6;
  out["closure_gap_um"] = contour.closed ? nlohmann::ordered_json(gap * 1e6) : nlohmann::ordered_json();
  out["limit_violations"] = run.limit_violations;
  out["time_s"] = run.time_s;
  out["time_estimate_s"] = plan.time_s();
  out["smoothing_um"] = plan.path.smoothing_m() * 1e6;
  out["harmonics"] = plan.path.harmonics();
  return out;
}

void write_contour_trace(const ContourRun& run, const std::filesystem::path& csv) {
  std::ofstream out(csv);
  out << "t_s,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w\n";
  for (const auto& row : run.rows) {
    out << fmt::format("{:.7f},{:.12f},{:.12f},{:.12f},{:.12f},{:.12f},{:.6g}\n", row.t_s,
                       row.reference.position_m.x(), row.reference.position_m.y(), row.tool_m.x(),
                       row.tool_m.y(), row.tool_m.z(), row.laser_w);
  }
  if (!out.flush()) throw Refusal(fmt::format("{}: cannot be written", csv.string()));
}

}  // namespace telekerf::experiments
