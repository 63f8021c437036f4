// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_figure.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/reporting/picture_file.h"
#include "common/reporting/plot.h"

namespace telekerf::experiments {
namespace {

using reporting::draw_figure;
using reporting::Line;
using reporting::Panel;

/// Rows of a run that a figure shows.
std::size_t stride_of(const ContourRun& run) { return std::max<std::size_t>(1, run.pass.rows.size() / 4000); }

Line path_line(const ContourRun& run, const std::string& label, Line::Style style, int colour,
               const std::function<Vec3(const machining::PassRow&)>& point, const Vec2* around = nullptr,
               double reach_m = 0.0) {
  Line line{label, {}, {}, style, colour};
  const std::size_t stride = around == nullptr ? stride_of(run) : 1;
  for (std::size_t i = 0; i < run.pass.rows.size(); i += stride) {
    const Vec3 p = point(run.pass.rows[i]);
    const bool inside = around == nullptr || (p.head<2>() - *around).cwiseAbs().maxCoeff() < reach_m;
    line.x.push_back(inside ? p.x() * 1e3 : NAN);
    line.y.push_back(inside ? p.y() * 1e3 : NAN);
  }
  return line;
}

Line trace_line(const ContourRun& run, const std::string& label, int colour,
                const std::function<double(const machining::PassRow&)>& value) {
  Line line{label, {}, {}, Line::Style::kSolid, colour};
  for (std::size_t i = 0; i < run.pass.rows.size(); i += stride_of(run)) {
    line.x.push_back(static_cast<double>(i) * run.pass.plan->period_s);
    line.y.push_back(value(run.pass.rows[i]));
  }
  return line;
}

}  // namespace

void draw_runs(const std::string& title, const std::vector<NamedRun>& runs, const cv::Mat& picture,
               const std::filesystem::path& mark, const std::filesystem::path& png) {
  const ContourRun& first = *runs.front().run;
  const auto reference = [](const machining::PassRow& row) { return row.reference.position_m; };
  const auto tool = [](const machining::PassRow& row) { return row.tool_m; };
  // Zoom: where the last run (the baseline, if there are two) is farthest off.
  const ContourRun& last = *runs.back().run;
  const auto worst =
      std::max_element(last.pass.rows.begin(), last.pass.rows.end(), [](const auto& a, const auto& b) {
        return std::abs(a.error_in_frame_m[1]) < std::abs(b.error_in_frame_m[1]);
      });
  const Vec2 place = worst->reference.position_m.head<2>();
  constexpr double kReach = 0.25e-3;

  Panel plane{.title = "contour", .x_label = "x [mm]", .y_label = "y [mm]", .equal_axes = true};
  Panel zoom{
      .title = "where the error is largest", .x_label = "x [mm]", .y_label = "y [mm]", .equal_axes = true};
  zoom.x_range = {{1e3 * (place.x() - kReach), 1e3 * (place.x() + kReach)}};
  zoom.y_range = {{1e3 * (place.y() - kReach), 1e3 * (place.y() + kReach)}};
  Panel speed{.title = "tangential speed", .x_label = "time [s]", .y_label = "[mm/s]"};
  Panel normal{.title = "error across the contour", .x_label = "time [s]", .y_label = "[um]"};
  plane.lines.push_back(path_line(first, "reference", Line::Style::kDashed, 7, reference));
  zoom.lines.push_back(path_line(first, "reference", Line::Style::kDashed, 7, reference, &place, kReach));
  int colour = 0;
  for (const auto& [name, run] : runs) {
    plane.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool));
    zoom.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool, &place, kReach));
    ++colour;
  }
  // The baseline lies below.
  for (std::size_t i = runs.size(); i-- > 0;) {
    const auto& [name, run] = runs[i];
    speed.lines.push_back(trace_line(*run, name, static_cast<int>(i), [](const machining::PassRow& row) {
      return 1e3 * row.tool_velocity_m_per_s.dot(row.reference.tangent);
    }));
    normal.lines.push_back(trace_line(*run, name, static_cast<int>(i), [](const machining::PassRow& row) {
      return 1e6 * row.error_in_frame_m[1];
    }));
  }
  reporting::Figure figure{.title = title,
                           .panels = {plane, zoom, speed, normal, {.title = "laser mark", .picture = mark}},
                           .columns = 2,
                           .panel_width_px = 560,
                           .panel_height_px = 400};
  if (!picture.empty()) {
    // A of the thesis' figures.
    const std::filesystem::path source = std::filesystem::path(png).replace_filename("source.png");
    reporting::write_picture(source, picture);
    figure.panels.insert(figure.panels.begin(), {.title = "source picture", .picture = source});
    figure.columns = 3;
    figure.panel_width_px = 480;
  }
  draw_figure(figure, png);
}

}  // namespace telekerf::experiments
