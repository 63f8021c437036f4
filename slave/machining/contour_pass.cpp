// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/contour_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/nearest.h"
#include "common/runtime/error_statistics.h"
#include "common/runtime/startup_error.h"
#include "common/workpiece/mark_along_path.h"
#include "common/workpiece/mark_picture.h"
#include "slave/laser/pulsed_beam.h"
#include "slave/machining/contouring_control.h"

namespace telekerf::machining {
namespace {

using geometry::NearestIndex;
using geometry::Polyline;
using nlohmann::ordered_json;

/// Nearer than this to a corner, measures are the corner's.
constexpr double kCornerReach_m = 0.4e-3;
constexpr double kCornerTurn_rad = std::numbers::pi / 6;
constexpr double kCornerWindow_m = 0.15e-3;

ordered_json um(const ErrorStatistics& spread) {
  return {{"rms", spread.rms() * 1e6}, {"max", spread.max * 1e6}};
}

bool near_any(const std::vector<Vec2>& places, const Vec2& p, double reach_m) {
  return std::any_of(places.begin(), places.end(),
                     [&](const Vec2& c) { return (c - p).squaredNorm() < reach_m * reach_m; });
}

/// How far the end of a closed cut runs from where it began, when it passes there again.
double closure_gap_m(const ContourPass& pass) {
  Polyline after;
  for (const auto& row : pass.rows) {
    if (row.reference.arc_length_m > 0.5 * pass.plan->path.length_m())
      after.points_m.push_back(row.tool_m.head<2>());
  }
  if (after.size() < 2) return 0.0;  // the pass was stopped
  return NearestIndex(after).find(pass.rows.front().tool_m.head<2>()).distance_m;
}

}  // namespace

PassRow pass_row(const Reference& reference, const Vec3& tool_m, const Vec3& tool_velocity_m_per_s,
                 double laser_w) noexcept {
  return {reference, tool_m, tool_velocity_m_per_s, laser_w,
          moving_frame(reference).rows * (reference.position_m - tool_m)};
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
  // A closed contour is gone round from a place that is no corner, so that the one at its start is seen
  // whole.
  std::size_t first = 0;
  while (contour.closed && first < count && turn[first] >= kCornerTurn_rad) ++first;
  const auto sharp = [&](std::size_t i) { return turn[(first + i) % count] >= kCornerTurn_rad; };
  const auto arc_m = [&](std::size_t i) {
    return static_cast<double>((first + i) % count) * step + (first + i < count ? 0.0 : length);
  };
  // One corner a run of sharp places: in its middle.
  std::vector<Vec2> corners;
  for (std::size_t i = 0; i < count; ++i) {
    if (!sharp(i)) continue;
    std::size_t end = i;
    while (end + 1 < count && sharp(end + 1)) ++end;
    const Vec2 place = index.at(0.5 * (arc_m(i) + arc_m(end))).point_m;
    // A smooth bend turns all the way: a corner does so within its window.
    const bool known = near_any(corners, place, 2 * kCornerWindow_m);
    if (!known && arc_m(end) - arc_m(i) < 6 * kCornerWindow_m) corners.push_back(place);
    i = end;
  }
  return corners;
}

ordered_json measure(std::span<const ContourPass> passes, double speed_m_per_s) {
  ErrorStatistics to_contour, to_reference, normal, tangential, height, model, model_everywhere, ripple,
      ripple_everywhere, ripple_at_corners;
  double speed_sum = 0.0, corner_error = 0.0, gap = 0.0, slowest = speed_m_per_s;
  std::size_t corner_count = 0;
  bool any_closed = false;
  for (const ContourPass& pass : passes) {
    slowest = std::min(slowest, pass.plan->slowest_m_per_s);
    if (pass.rows.size() < 2) continue;
    const NearestIndex extracted(*pass.contour);
    Polyline reference_line, tool_line;
    for (const auto& row : pass.rows) {
      reference_line.points_m.push_back(row.reference.position_m.head<2>());
      tool_line.points_m.push_back(row.tool_m.head<2>());
    }
    const NearestIndex reference(reference_line);
    const NearestIndex tool(tool_line);
    const std::vector<Vec2> corners = corners_of(*pass.contour);
    corner_count += corners.size();
    for (const auto& row : pass.rows) {
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
      const double too_fast = speed - row.reference.speed_m_per_s;
      model_everywhere.add(off);
      ripple_everywhere.add(too_fast);
      if (near_any(corners, at, kCornerReach_m)) {
        ripple_at_corners.add(too_fast);
        continue;
      }
      model.add(off);
      ripple.add(too_fast);
    }
    const double cut_to_m = pass.rows.back().reference.arc_length_m;
    for (const Vec2& corner : corners) {
      if (extracted.find(corner).arc_length_m < cut_to_m)
        corner_error = std::max(corner_error, tool.find(corner).distance_m);
    }
    if (pass.contour->closed) {
      any_closed = true;
      gap = std::max(gap, closure_gap_m(pass));
    }
  }
  const double mean = normal.count == 0 ? 0.0 : speed_sum / static_cast<double>(normal.count);
  const auto percent = [&](double deviation) { return mean > 0.0 ? 100.0 * deviation / mean : 0.0; };
  return {{"contour_error_um", um(to_contour)},
          {"reference_error_um", um(to_reference)},
          {"normal_error_um", um(normal)},
          {"tangential_error_um", um(tangential)},
          {"height_error_um", um(height)},
          {"model_error_um",
           {{"rms", model.rms() * 1e6},
            {"max", model.max * 1e6},
            {"max_at_corners", model_everywhere.max * 1e6}}},
          {"tangential_speed",
           {{"commanded_mm_s", speed_m_per_s * 1e3},
            {"mean_mm_s", mean * 1e3},
            {"ripple_percent", percent(ripple.rms())},
            {"ripple_peak_percent", percent(ripple.max)},
            {"ripple_everywhere_percent", percent(ripple_everywhere.rms())},
            {"ripple_everywhere_peak_percent", percent(ripple_everywhere.max)},
            {"ripple_at_corners_peak_percent",
             ripple_at_corners.count > 0 ? ordered_json(percent(ripple_at_corners.max)) : ordered_json()},
            {"slowest_planned_mm_s", slowest * 1e3}}},
          {"corners", corner_count},
          {"corner_error_um", corner_error * 1e6},
          {"closure_gap_um", any_closed ? ordered_json(gap * 1e6) : ordered_json()}};
}

ordered_json burn(std::span<const ContourPass> passes, const workpiece::Material& material,
                  const std::filesystem::path& folder) {
  std::vector<Vec2> all;
  for (const ContourPass& pass : passes)
    all.insert(all.end(), pass.contour->points_m.begin(), pass.contour->points_m.end());
  const geometry::Box box = geometry::bounding_box(all);
  laser::PulsedSourceSettings source;
  double most_w = source.max_power_w;
  for (const ContourPass& pass : passes) {
    for (const PassRow& row : pass.rows) most_w = std::max(most_w, row.laser_w);
  }
  // A stronger laser has more pulses of the same energy.
  source.repetition_hz *= most_w / source.max_power_w;
  source.max_power_w = most_w;
  const double half_width_m = 0.5 * box.size().maxCoeff() + geometry::kCorridorHalfWidth_m;
  workpiece::Workpiece workpiece({.centre_m = box.centre(),
                                  .half_width_m = half_width_m,
                                  .pixels = workpiece::pixels_for(half_width_m, 7.5e-6)},
                                 material);
  laser::PulsedBeam beam(source, workpiece);
  std::vector<Polyline> paths;
  for (const ContourPass& pass : passes) {
    const NearestIndex corridor(*pass.contour);
    paths.push_back({{}, pass.contour->closed});
    for (std::size_t i = 0; i + 1 < pass.rows.size(); ++i) {
      const PassRow& row = pass.rows[i];
      const Vec2 from = row.tool_m.head<2>();
      beam.expose(from, pass.rows[i + 1].tool_m.head<2>(), row.laser_w, pass.plan->period_s, &corridor);
      if (row.reference.arc_length_m < pass.plan->path.length_m()) paths.back().points_m.push_back(from);
    }
  }
  // Only when everything is burned: a later contour may cross an earlier one.
  workpiece::MarkAlongPath whole;
  double length = 0.0;
  for (const Polyline& path : paths) {
    if (path.size() < 3) continue;
    const workpiece::MarkAlongPath mark = workpiece::measure_mark(workpiece, path, source.spot_radius_m);
    const double share = geometry::length_m(path);
    whole.depth_m += share * mark.depth_m;
    whole.kerf_m += share * mark.kerf_m;
    whole.depth_variation = std::max(whole.depth_variation, mark.depth_variation);
    length += share;
  }
  if (!cv::imwrite((folder / "mark.png").string(), workpiece::picture_of(workpiece)) ||
      !cv::imwrite((folder / "depth.png").string(), workpiece::depth_picture(workpiece))) {
    throw environment_error(folder.string() + ": cannot be written");
  }
  const laser::EnergyStatistics& energy = beam.energy();
  return {{"material", material.name},
          {"depth_um", length > 0.0 ? 1e6 * whole.depth_m / length : 0.0},
          {"depth_variation_percent", 100.0 * whole.depth_variation},
          {"kerf_um", length > 0.0 ? 1e6 * whole.kerf_m / length : 0.0},
          {"energy_inside_j", energy.inside_j},
          {"energy_outside_corridor_j", energy.outside_j},
          {"absorbed_j", energy.absorbed_j}};
}

}  // namespace telekerf::machining
