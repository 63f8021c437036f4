// SPDX-License-Identifier: Apache-2.0
#include "experiments/remote/remote_figure.h"

#include <cmath>

#include "common/reporting/picture_file.h"
#include "common/reporting/plot.h"
#include "common/workpiece/mark_picture.h"

namespace telekerf::experiments {
namespace {

using reporting::Line;
using reporting::Panel;

using Sample = RemoteSample;

Panel plane(const std::string& title, std::vector<Line> lines) {
  return {.title = title,
          .x_label = "x [mm]",
          .y_label = "y [mm]",
          .lines = std::move(lines),
          .equal_axes = true};
}
Panel speeds(const std::string& title, std::vector<Line> lines) {
  return {.title = title,
          .x_label = "time [s]",
          .y_label = "along the contour [mm/s]",
          .lines = std::move(lines)};
}

Line path(const std::vector<Sample>& motion, const std::string& label, Vec2 Sample::*point, Line::Style style,
          int colour) {
  Line line{.label = label, .style = style, .colour = colour};
  const Sample* before = nullptr;
  for (const Sample& sample : motion) {
    if (before != nullptr && sample.time_s - before->time_s > 0.1)
      line.x.push_back(NAN), line.y.push_back(NAN);
    line.x.push_back(1e3 * (sample.*point).x());
    line.y.push_back(1e3 * (sample.*point).y());
    before = &sample;
  }
  return line;
}

Line over_time(const std::vector<Sample>& motion, const std::string& label, double Sample::*speed,
               Line::Style style, int colour) {
  Line line{.label = label, .style = style, .colour = colour};
  for (const Sample& sample : motion) {
    line.x.push_back(sample.time_s);
    line.y.push_back(1e3 * sample.*speed);
  }
  return line;
}

/// Depth, and what it would be if it were the dwell times one number: the same mean.
Panel depths(const std::string& title, const DepthAlong& mark, bool with_dwell) {
  Line depth{.label = "depth", .colour = 0}, dwell{.label = "time lit, scaled", .colour = 1};
  double depth_sum = 0.0, dwell_sum = 0.0;
  for (std::size_t i = 0; i < mark.arc_m.size(); ++i) {
    depth_sum += mark.depth_m[i];
    dwell_sum += mark.dwell_s_per_m[i];
  }
  for (std::size_t i = 0; i < mark.arc_m.size(); ++i) {
    depth.x.push_back(1e3 * mark.arc_m[i]);
    depth.y.push_back(1e3 * mark.depth_m[i]);
    dwell.y.push_back(dwell_sum > 0.0 ? 1e3 * mark.dwell_s_per_m[i] * depth_sum / dwell_sum : 0.0);
  }
  dwell.x = depth.x;
  Panel panel{.title = title, .x_label = "along the contour [mm]", .y_label = "depth [mm]", .lines = {depth}};
  if (with_dwell) panel.lines.insert(panel.lines.begin(), dwell);
  return panel;
}

}  // namespace

void draw_remote(const std::string& title, const std::vector<RemoteSample>& motion, const RemoteMarks& marks,
                 const std::filesystem::path& png) {
  constexpr auto kSolid = Line::Style::kSolid, kDashed = Line::Style::kDashed;
  constexpr int kPixels = 600;
  const auto picture = [&](const char* what, const cv::Mat& drawn) {
    std::filesystem::path file = png;
    file.replace_filename(png.stem().string() + "-" + what + ".png");
    reporting::write_picture(file, drawn);
    return file;
  };
  const workpiece::Workpiece &fibreglass = marks.fibreglass.workpiece, &wood = marks.wood.workpiece;
  reporting::draw_figure(
      {.title = title,
       .panels = {plane("(A) master", {path(motion, "", &Sample::master_m, kSolid, 0)}),
                  plane("(B) slave", {path(motion, "", &Sample::slave_m, kSolid, 1)}),
                  plane("(C) master and rescaled slave",
                        {path(motion, "master", &Sample::master_m, kSolid, 0),
                         path(motion, "slave / beta", &Sample::rescaled_m, kDashed, 1)}),
                  speeds("(D) master's tangential velocity",
                         {over_time(motion, "", &Sample::master_m_per_s, kSolid, 0)}),
                  speeds("(E) slave's tangential velocity",
                         {over_time(motion, "", &Sample::slave_m_per_s, kSolid, 1)}),
                  speeds("(F) master and rescaled slave, at the tick applied",
                         {over_time(motion, "master", &Sample::master_m_per_s, kSolid, 0),
                          over_time(motion, "slave / beta", &Sample::rescaled_m_per_s, kDashed, 1)}),
                  {.title = "(G) fibreglass",
                   .picture = picture("fibreglass", workpiece::picture_of(fibreglass, kPixels))},
                  {.title = "(H) fibreglass, depth",
                   .picture = picture("fibreglass-depth", workpiece::depth_picture(fibreglass, kPixels))},
                  {.title = "(I) wood", .picture = picture("wood", workpiece::picture_of(wood, kPixels))},
                  depths("wood, constant power: the operator's speed decides", marks.wood, true),
                  depths("wood, power that follows the speed", marks.wood_by_speed, false)},
       .columns = 3,
       .panel_width_px = 480,
       .panel_height_px = 340},
      png);
}

void draw_network_speeds(const std::string& title, const std::vector<NetworkRun>& runs,
                         const std::filesystem::path& png) {
  reporting::Figure figure{.title = title, .columns = 3, .panel_width_px = 400, .panel_height_px = 240};
  for (const NetworkRun& run : runs)
    figure.panels.push_back(
        speeds(run.network,
               {over_time(run.motion, "master", &Sample::master_m_per_s, Line::Style::kSolid, 0),
                over_time(run.motion, "slave / beta", &Sample::rescaled_m_per_s, Line::Style::kDashed, 1)}));
  reporting::draw_figure(figure, png);
}

void draw_network_depths(const std::string& title, const std::vector<NetworkRun>& runs,
                         const std::filesystem::path& png) {
  reporting::Figure figure{.title = title, .columns = 3, .panel_width_px = 400, .panel_height_px = 240};
  for (const NetworkRun& run : runs) figure.panels.push_back(depths(run.network, run.wood, true));
  reporting::draw_figure(figure, png);
}

}  // namespace telekerf::experiments
