// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extract.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/vision/modes.h"

namespace telekerf::vision {
namespace {

constexpr std::array<std::pair<Mode, std::string_view>, 4> kNames{{{Mode::kAuto, "auto"},
                                                                   {Mode::kThesis, "thesis"},
                                                                   {Mode::kOutline, "outline"},
                                                                   {Mode::kStroke, "stroke"}}};
constexpr double kSmallestLengthPx = 16.0;

double size_of(const PixelContour& contour) {
  const geometry::Polyline line{contour.points_px, contour.closed};
  return contour.closed ? std::sqrt(std::abs(geometry::signed_area_m2(line))) : geometry::length_m(line);
}

/// Largest first; specks go.
void keep_large(Contours& contours, double smallest_share) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (geometry::length_m({contours[i].points_px, contours[i].closed}) < kSmallestLengthPx) continue;
    order.emplace_back(size_of(contours[i]), i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  Contours kept;
  for (const auto& [size, i] : order) {
    if (size >= smallest_share * order.front().first) kept.push_back(std::move(contours[i]));
  }
  contours = std::move(kept);
}

void start_near(PixelContour& contour, const Vec2& start) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < contour.points_px.size(); ++i) {
    if ((contour.points_px[i] - start).norm() < (contour.points_px[best] - start).norm()) best = i;
  }
  if (contour.closed) {
    std::rotate(contour.points_px.begin(), contour.points_px.begin() + best, contour.points_px.end());
  } else if (2 * best > contour.points_px.size()) {
    std::reverse(contour.points_px.begin(), contour.points_px.end());
  }
}

tl::expected<Contours, std::string> outline_mode(const Field& field, const ExtractSettings& settings) {
  Outlines found = outlines_of(field);
  for (PixelContour& contour : found.contours) {
    // Pixels run downwards, so what is anticlockwise to the eye has a negative area here.
    contour.hole = geometry::signed_area_m2({contour.points_px, true}) > 0.0;
  }
  keep_large(found.contours, settings.smallest_share);
  if (found.contours.empty()) {
    return tl::unexpected<std::string>(
        found.cut_off > 0 ? "every shape touches the picture's border, so no outline is whole; show "
                            "the shape with background all around it"
                          : "the picture holds specks only, no shape with an outline");
  }
  for (PixelContour& contour : found.contours) smooth_and_resample(contour, 1.0);
  return std::move(found.contours);
}

}  // namespace

std::string_view name_of(Mode mode) {
  return std::find_if(kNames.begin(), kNames.end(), [&](const auto& n) { return n.first == mode; })->second;
}

std::optional<Mode> mode_of(std::string_view name) {
  const auto found =
      std::find_if(kNames.begin(), kNames.end(), [&](const auto& n) { return n.second == name; });
  return found == kNames.end() ? std::nullopt : std::optional(found->first);
}

tl::expected<Extraction, std::string> extract(const cv::Mat& image, const ExtractSettings& settings) {
  const auto grey = grey_plane(image);
  if (!grey) return tl::unexpected(grey.error());
  const auto field = make_field(*grey);
  if (!field) return tl::unexpected(field.error());

  Extraction out;
  out.picture_width_px = image.cols;
  out.picture_height_px = image.rows;
  out.mode = Mode::kOutline;
  out.why = "asked for";
  auto contours = outline_mode(*field, settings);
  if (!contours) return tl::unexpected(contours.error());
  out.contours = std::move(*contours);
  if (settings.start_px) start_near(out.contours.front(), *settings.start_px);
  return out;
}

}  // namespace telekerf::vision
