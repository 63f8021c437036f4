// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_figure.h"

#include <fmt/format.h>

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
  // Of each stretch the least and the largest, so that no peak is lost.
  Line line{label, {}, {}, Line::Style::kSolid, colour};
  const auto& rows = run.pass.rows;
  const std::size_t stretch = 2 * stride_of(run);
  for (std::size_t from = 0; from < rows.size(); from += stretch) {
    std::size_t low = from, high = from;
    for (std::size_t i = from; i < std::min(from + stretch, rows.size()); ++i) {
      if (value(rows[i]) < value(rows[low])) low = i;
      if (value(rows[i]) > value(rows[high])) high = i;
    }
    for (const std::size_t i : {std::min(low, high), std::max(low, high)}) {
      line.x.push_back(static_cast<double>(i) * run.pass.plan->period_s);
      line.y.push_back(value(rows[i]));
    }
  }
  return line;
}

std::string titled(char letter, const std::string& words) {
  return letter == 0 ? words : fmt::format("({}) {}", letter, words);
}

Panel plane(char letter, const std::string& title) {
  return {.title = titled(letter, title),
          .x_label = "position x [mm]",
          .y_label = "position y [mm]",
          .equal_axes = true};
}

Panel over_time(char letter, const std::string& title, const std::string& axis) {
  return {.title = titled(letter, title), .x_label = "time [s]", .y_label = axis};
}

/// The points that vision found, as many as can be told apart, and the curve fitted to them.
Panel model_panel(const ContourRun& run, char letter) {
  Panel panel = plane(
      letter, fmt::format("detected contour and fitted EFD, {} harmonics", run.pass.plan->path.harmonics()));
  constexpr std::size_t kPoints = 150;
  const auto& found = run.pass.contour->points_m;
  Line points{.label = "detected contour", .style = Line::Style::kPoints, .colour = 1};
  for (std::size_t k = 0; k < std::min(kPoints, found.size()); ++k) {
    const Vec2& p = found[k * found.size() / std::min(kPoints, found.size())];
    points.x.push_back(1e3 * p.x());
    points.y.push_back(1e3 * p.y());
  }
  panel.lines = {points, path_line(run, "fitted EFD", Line::Style::kSolid, 0,
                                   [](const machining::PassRow& row) { return row.reference.position_m; })};
  return panel;
}

}  // namespace

void draw_runs(const std::string& title, const std::vector<NamedRun>& runs, const cv::Mat& picture,
               const std::filesystem::path& mark, const PanelLetters& letters,
               const std::filesystem::path& png) {
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

  const bool closed = first.pass.contour->closed;
  const std::string reference_name = closed ? "reference (EFD)" : "reference";
  Panel tracking = plane(letters.tracking, "tracking in the plane");
  Panel zoom = plane(letters.zoom, "zoom: where the error is largest");
  zoom.x_range = {{1e3 * (place.x() - kReach), 1e3 * (place.x() + kReach)}};
  zoom.y_range = {{1e3 * (place.y() - kReach), 1e3 * (place.y() + kReach)}};
  Panel speed = over_time(letters.speed, "tangential velocity", "tangential velocity [mm/s]");
  Panel speed_error = over_time(letters.speed_error, "tangential velocity tracking error",
                                "reference - tool, tangential velocity [mm/s]");
  Panel across = over_time(letters.across, "error in normal direction", "error across the contour [um]");
  tracking.lines.push_back(path_line(first, reference_name, Line::Style::kDashed, 7, reference));
  zoom.lines.push_back(path_line(first, reference_name, Line::Style::kDashed, 7, reference, &place, kReach));
  int colour = 0;
  for (const auto& [name, run] : runs) {
    tracking.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool));
    zoom.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool, &place, kReach));
    ++colour;
  }
  // The baseline lies below.
  for (std::size_t i = runs.size(); i-- > 0;) {
    const auto line = [&](const std::function<double(const machining::PassRow&)>& value) {
      return trace_line(*runs[i].run, runs[i].name, static_cast<int>(i), value);
    };
    const auto velocity = [](const machining::PassRow& row) {
      return 1e3 * row.tool_velocity_m_per_s.dot(row.reference.tangent);
    };
    speed.lines.push_back(line(velocity));
    speed_error.lines.push_back(line(
        [&](const machining::PassRow& row) { return 1e3 * row.reference.speed_m_per_s - velocity(row); }));
    across.lines.push_back(line([](const machining::PassRow& row) { return 1e6 * row.error_in_frame_m[1]; }));
  }
  Line commanded = trace_line(
      first, "reference", 7, [](const machining::PassRow& row) { return 1e3 * row.reference.speed_m_per_s; });
  commanded.style = Line::Style::kDashed;
  speed.lines.push_back(commanded);
  reporting::Figure figure{
      .title = title, .panels = {tracking}, .columns = 2, .panel_width_px = 560, .panel_height_px = 400};
  if (closed) figure.panels.push_back(model_panel(first, letters.model));
  for (const Panel& panel : {zoom, speed, speed_error, across}) figure.panels.push_back(panel);
  figure.panels.push_back({.title = titled(letters.mark, "what the laser left"), .picture = mark});
  if (!picture.empty()) {
    // A of the thesis' figures.
    const std::filesystem::path source = std::filesystem::path(png).replace_filename("source.png");
    reporting::write_picture(source, picture);
    figure.panels.insert(figure.panels.begin(),
                         {.title = titled(letters.picture, "source picture"), .picture = source});
    figure.columns = 3;
    figure.panel_width_px = 480;
  }
  draw_figure(figure, png);
}

void draw_pictures_and_marks(const std::vector<std::filesystem::path>& folders, std::string_view material,
                             const std::filesystem::path& png) {
  reporting::Figure figure{.columns = static_cast<int>(folders.size())};
  char letter = 'A';
  for (const auto& [file, what] : {std::pair{"source.png", std::string("source picture")},
                                   std::pair{"mark.png", "laser mark on " + std::string(material)}})
    for (const std::filesystem::path& folder : folders)
      figure.panels.push_back(
          {.title = titled(letter++, fmt::format("{}, {}", folder.filename().string(), what)),
           .picture = folder / file});
  draw_figure(figure, png);
}

}  // namespace telekerf::experiments
