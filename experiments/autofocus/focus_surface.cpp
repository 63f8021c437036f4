// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/reporting/picture_file.h"
#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "experiments/autofocus/focus_story.h"
#include "slave/vision/imaging/sharpness.h"

namespace telekerf::experiments {
namespace {

using namespace imaging;
using reporting::Line;
using reporting::Panel;

constexpr double kLowestFocus_m = 0.008, kFocusTravel_m = 0.014;
constexpr double kHalfWay_m = 0.04;  ///< of the magnification axis

/// `count` places from `from_m` to `to_m`.
std::vector<double> places(double from_m, double to_m, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(from_m + (to_m - from_m) * i / (count - 1));
  return out;
}

/// What the camera sees at some places of one axis, and the sharpness over all of its way.
void draw_sweep(const std::string& number, const std::string& axis, VirtualUnit& unit,
                const std::vector<AxisPositions>& way, double AxisPositions::*moved,
                const std::filesystem::path& folder) {
  constexpr std::size_t kPictures = 8;
  Line line;
  std::vector<cv::Mat> pictures;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const cv::Mat picture = unit.microscope().picture(way[i], 0.0);
    line.x.push_back(1e3 * way[i].*moved);
    line.y.push_back(normalised_variance(grey_sums(picture)));
    if (pictures.size() * (way.size() - 1) > i * (kPictures - 1)) continue;
    pictures.emplace_back();
    cv::cvtColor(picture, pictures.back(), cv::COLOR_GRAY2BGR);
    cv::putText(pictures.back(), fmt::format("{:.1f} mm", line.x.back()), {4, 122}, cv::FONT_HERSHEY_SIMPLEX,
                0.4, {0, 255, 255}, 1, cv::LINE_AA);
  }
  cv::Mat strip;
  cv::hconcat(pictures, strip);
  const std::filesystem::path file = folder / ("figure-" + number + "-pictures.png");
  reporting::write_picture(file, strip);
  reporting::draw_figure({.title = number + " the " + axis + " motor moves, the other one stands still",
                          .panels = {{.title = "what the camera saw", .picture = file},
                                     {.title = "sharpness (eq. 155)",
                                      .x_label = axis + " axis [mm]",
                                      .y_label = "normalised variance [grey levels]",
                                      .lines = {line}}},
                          .panel_width_px = strip.cols + 40,
                          .panel_height_px = 240},
                         folder / ("figure-" + number + ".png"));
}

void draw_sweeps(std::uint64_t seed, const std::filesystem::path& folder) {
  constexpr int kPlaces = 141;
  VirtualUnit unit = story_unit(seed, kHalfWay_m, 0.0);
  const ImagingModel& model = unit.microscope().settings().model;
  std::vector<AxisPositions> way;
  for (const double at_m : places(0.0, model.magnification_travel_m, kPlaces))
    way.push_back({.magnification_m = at_m, .focus_m = model.best_focus_m(kHalfWay_m)});
  draw_sweep("7.10", "magnification", unit, way, &AxisPositions::magnification_m, folder);
  way.clear();
  for (const double at_m : places(kLowestFocus_m, kLowestFocus_m + kFocusTravel_m, kPlaces))
    way.push_back({.magnification_m = kHalfWay_m, .focus_m = at_m});
  draw_sweep("7.11", "focus", unit, way, &AxisPositions::focus_m, folder);
}

void draw_raster(const SharpnessSurface& surface, const std::filesystem::path& folder) {
  cv::Mat values(static_cast<int>(surface.magnification_m.size()), static_cast<int>(surface.focus_m.size()),
                 CV_32F);
  Panel along_focus{.title = "B: focus, at several magnifications",
                    .x_label = "focus axis [mm]",
                    .y_label = "normalised variance [grey levels]"};
  Panel along_zoom{.title = "A: magnification, at several focuses",
                   .x_label = "magnification axis [mm]",
                   .y_label = "normalised variance [grey levels]"};
  Panel raster{
      .title = "sharpness over both axes", .x_label = along_focus.x_label, .y_label = along_focus.y_label};
  Line ridge;
  Line heights;
  for (std::size_t i = 0; i < surface.magnification_m.size(); ++i) {
    const auto& row = surface.sharpness[i];
    const auto top = static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
    ridge.x.push_back(1e3 * surface.magnification_m[i]);
    ridge.y.push_back(1e3 * surface.focus_m[top]);
    heights.x.push_back(1e3 * surface.magnification_m[i]);
    heights.y.push_back(row[top]);
    Line line{.label = fmt::format("{:.1f} mm", 1e3 * surface.magnification_m[i])};
    for (std::size_t j = 0; j < row.size(); ++j) {
      values.at<float>(values.rows - 1 - static_cast<int>(i), static_cast<int>(j)) =
          static_cast<float>(row[j]);
      line.x.push_back(1e3 * surface.focus_m[j]);
      line.y.push_back(row[j]);
    }
    if (i % 6 == 0) along_focus.lines.push_back(line);
    line.label = fmt::format("magnification axis {:.4g} mm", 1e3 * surface.magnification_m[i]);
    raster.lines.push_back(line);
  }
  for (std::size_t j = 0; j < surface.focus_m.size();
       j += std::max<std::size_t>(1, surface.focus_m.size() / 7)) {
    Line line{.label = fmt::format("{:.1f} mm", 1e3 * surface.focus_m[j])};
    for (std::size_t i = 0; i < surface.magnification_m.size(); ++i) {
      line.x.push_back(1e3 * surface.magnification_m[i]);
      line.y.push_back(surface.sharpness[i][j]);
    }
    along_zoom.lines.push_back(line);
  }
  cv::Mat eight;
  cv::normalize(values, eight, 0, 255, cv::NORM_MINMAX, CV_8U);
  cv::resize(eight, eight, {640, 480}, 0, 0, cv::INTER_CUBIC);
  cv::applyColorMap(eight, eight, cv::COLORMAP_VIRIDIS);
  const std::filesystem::path colours = folder / "figure-7.12-colours.png";
  reporting::write_picture(colours, eight);
  const auto ends_mm = [](const std::vector<double>& axis_m) {
    return std::array{1e3 * axis_m.front(), 1e3 * axis_m.back()};
  };
  reporting::draw_figure({.title = "7.12 sharpness (eq. 155) from above: the brighter, the sharper",
                          .panels = {{.x_label = "focus axis [mm]",
                                      .y_label = "magnification axis [mm]",
                                      .x_range = ends_mm(surface.focus_m),
                                      .y_range = ends_mm(surface.magnification_m),
                                      .picture = colours}},
                          .panel_width_px = 640,
                          .panel_height_px = 480},
                         folder / "figure-7.12.png");
  write_atomically(folder / "figure-7.12.csv", reporting::figure_csv({.panels = {raster}}));
  reporting::draw_figure({.title = "7.13 sharpness (eq. 155) along each axis",
                          .panels = {along_zoom, along_focus},
                          .columns = 2},
                         folder / "figure-7.13.png");
  reporting::draw_figure({.title = "7.14 the ridge",
                          .panels = {{.title = "where it is sharpest",
                                      .x_label = "magnification axis [mm]",
                                      .y_label = "focus axis [mm]",
                                      .lines = {ridge}},
                                     {.title = "how sharp it is there",
                                      .x_label = "magnification axis [mm]",
                                      .y_label = "normalised variance [grey levels]",
                                      .lines = {heights}}},
                          .columns = 2},
                         folder / "figure-7.14.png");
}

}  // namespace

SharpnessSurface sharpness_surface(std::uint64_t seed, int magnifications, int focuses) {
  VirtualUnit unit = story_unit(seed, kHalfWay_m, 0.0);
  const ImagingModel& model = unit.microscope().settings().model;
  SharpnessSurface out;
  out.focus_m = places(kLowestFocus_m, kLowestFocus_m + kFocusTravel_m, focuses);
  out.magnification_m = places(0.0, model.magnification_travel_m, magnifications);
  for (const double magnification_m : out.magnification_m) {
    auto& row = out.sharpness.emplace_back();
    for (const double focus_m : out.focus_m) {
      const cv::Mat picture = unit.microscope().picture({magnification_m, focus_m}, 0.0);
      row.push_back(normalised_variance(grey_sums(picture)));
    }
  }
  return out;
}

void draw_surface(std::uint64_t seed, const std::filesystem::path& folder) {
  draw_sweeps(seed, folder);
  draw_raster(sharpness_surface(seed, 41, 61), folder);
}

}  // namespace telekerf::experiments
