// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment space-contour: contouring in space (thesis 9.2), a flat contour laid onto curved
// workpieces.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/machining/contour_run.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;

struct Options : QuickForm {
  double speed_mm_s = 8.0;
  double radius_mm = 8.0;
  double curvature_mm = 30.0;
  std::uint64_t seed = 1;
  std::string out = "out/space-contour";
};

machining::Surface sphere_cap(const Vec2& p, double radius_m) {
  const double z = std::sqrt(radius_m * radius_m - p.squaredNorm());
  machining::Surface s;
  s.height_m = z - radius_m;
  s.slope = -p / z;
  s.curvature = -Eigen::Matrix2d::Identity() / z - p * p.transpose() / (z * z * z);
  return s;
}

machining::Surface saddle(const Vec2& p, double radius_m) {
  machining::Surface s;
  s.height_m = (p.x() * p.x() - p.y() * p.y()) / (2.0 * radius_m);
  s.slope = Vec2(p.x(), -p.y()) / radius_m;
  s.curvature = Eigen::Vector2d(1.0, -1.0).asDiagonal();
  s.curvature /= radius_m;
  return s;
}

/// A rounded clover: it turns left and right.
geometry::Polyline clover(double radius_m) {
  geometry::Polyline line{{}, true};
  for (int i = 0; i < 1200; ++i) {
    const double t = 2.0 * std::numbers::pi * i / 1200;
    const double r = radius_m * (0.8 + 0.2 * std::cos(4.0 * t));
    line.points_m.emplace_back(r * std::cos(t), r * std::sin(t));
  }
  return line;
}

nlohmann::ordered_json spread(const ContourRun& run, int axis) {
  double squares = 0.0, max = 0.0;
  for (const auto& row : run.pass.rows) {
    squares += row.error_in_frame_m[axis] * row.error_in_frame_m[axis];
    max = std::max(max, std::abs(row.error_in_frame_m[axis]));
  }
  return {{"rms", 1e6 * std::sqrt(squares / static_cast<double>(run.pass.rows.size()))}, {"max", 1e6 * max}};
}

int run(Options& options) {
  if (options.radius_mm > 0.95 * options.curvature_mm) {
    throw usage_error(fmt::format(
        "radius_mm = {:g}: must be at most {:g}, 95 % of curvature_mm, where a sphere is still not steep",
        options.radius_mm, 0.95 * options.curvature_mm));
  }
  const std::filesystem::path out = options.out;
  ContourRunSettings settings;
  settings.plan.speed_m_per_s = options.speed_mm_s * 1e-3;
  settings.follower.loop_delay = 1;
  settings.follower = tuned_follower(robot::load_robot(settings.robot), settings);
  settings.seed = options.seed;
  const geometry::Polyline flat_contour = clover(options.radius_mm * 1e-3);
  const auto flat = machining::Path::through(flat_contour, machining::path_settings(settings.plan));
  if (!flat) throw input_error(flat.error());

  nlohmann::ordered_json result{{"experiment", "space-contour"}, {"speed_mm_s", options.speed_mm_s}};
  Figure figure{.title = fmt::format("contours on curved workpieces at {:g} mm/s", options.speed_mm_s),
                .columns = 2};
  constexpr double kBar_um = 8.0;
  bool good = true;
  for (const std::string name : {"sphere-cap", "saddle"}) {
    const double radius_m = options.curvature_mm * 1e-3;
    auto path = machining::wrapped(*flat, [&](const Vec2& p) {
      return name == "saddle" ? saddle(p, radius_m) : sphere_cap(p, radius_m);
    });
    if (!path) throw input_error(path.error());
    const auto plan = machining::make_timed_path(std::move(*path), settings.plan);
    if (!plan) throw input_error(plan.error());
    const ContourRun run = run_contour(*plan, flat_contour, settings);
    double low = 0.0, high = 0.0;
    Line across{"normal", {}, {}}, up{"binormal", {}, {}}, height{"", {}, {}};
    for (std::size_t i = 0; i < run.pass.rows.size(); ++i) {
      const auto& row = run.pass.rows[i];
      low = std::min(low, row.reference.position_m.z());
      high = std::max(high, row.reference.position_m.z());
      if (i % 8 != 0) continue;
      for (Line* line : {&across, &up, &height}) line->x.push_back(static_cast<double>(i) * plan->period_s);
      across.y.push_back(1e6 * row.error_in_frame_m[1]);
      up.y.push_back(1e6 * row.error_in_frame_m[2]);
      height.y.push_back(1e3 * row.tool_m.z());
    }
    result[name] = {{"normal_error_um", spread(run, 1)},        {"binormal_error_um", spread(run, 2)},
                    {"tangential_error_um", spread(run, 0)},    {"height_mm", {1e3 * low, 1e3 * high}},
                    {"limit_violations", run.limit_violations}, {"time_s", run.time_s}};
    good = good && result[name]["normal_error_um"]["rms"].get<double>() <= kBar_um &&
           result[name]["binormal_error_um"]["rms"].get<double>() <= kBar_um;
    make_folder("--out", out);
    write_contour_trace(run, out / (name + ".csv"));
    figure.panels.push_back(
        {.title = name + ": height", .x_label = "time [s]", .y_label = "z [mm]", .lines = {height}});
    figure.panels.push_back(
        {.title = name + ": errors", .x_label = "time [s]", .y_label = "[um]", .lines = {across, up}});
  }
  result["bar_um"] = kBar_um;
  result["good"] = good;
  draw_figure(figure, out / "space-contour.png");
  write_result(out / "result.json", result, options.seed);
  fmt::print("{}\n", json_text(result));
  return good ? 0 : 1;
}

void add_parameters(Options& o, Settings& s) {
  s.add("speed_mm_s", o.speed_mm_s, {.min = 0.1, .max = 100, .unit = "mm/s"}, "tangential speed");
  s.add("radius_mm", o.radius_mm, {.min = 1, .max = 20, .unit = "mm"}, "of the contour");
  s.add("curvature_mm", o.curvature_mm, {.min = 10, .max = 1000, .unit = "mm"},
        "radius of curvature of the workpiece");
  s.add("seed", o.seed, kSeeds, "of everything random");
  o.add_quick(s);
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_space_contour_command(Program& program) {
  program.add("space-contour",
              "Thesis 9.2: contouring on a sphere cap and on a saddle; result.json, traces, figure",
              Options{}, add_parameters, run);
}

}  // namespace telekerf::experiments
