// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/separation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "common/vision/raster/shadow.h"

namespace telekerf::vision {
namespace {

constexpr int kMaxSpecks = 60;

/// Most of the picture's border is drawn.
bool frames(const cv::Mat& drawn) {
  const int last_row = drawn.rows - 1;
  const int last_column = drawn.cols - 1;
  const int along = cv::countNonZero(drawn.row(0)) + cv::countNonZero(drawn.row(last_row)) +
                    cv::countNonZero(drawn.col(0)) + cv::countNonZero(drawn.col(last_column));
  return along > drawn.rows + drawn.cols;
}

/// Shapes as thin as the filter lets them be, none of which stands out among the others.
int specks_in(const Field& field, const Outlines& outlines, double largest_px) {
  if (outlines.width_px > 2.0 * field.sigma_px + 1.5) return 0;
  return static_cast<int>(
      std::count_if(outlines.contours.begin(), outlines.contours.end(),
                    [&](const PixelContour& c) { return size_px(c) > 0.3 * largest_px; }));
}

/// Texture has no end at the picture's border and no shape that stands out: the largest one covers little of
/// what is drawn, and little of what is whole.
bool is_texture(const Field& field, const Outlines& outlines, double& fraction) {
  double whole = 0.0;
  double largest = 0.0;
  for (const double area : outlines.areas_px) {
    whole += std::max(0.0, area);
    largest = std::max(largest, area);
  }
  fraction = largest / std::max(1, cv::countNonZero(field.drawn));
  return (outlines.cut_off >= 3 && fraction < 0.35 && largest < 0.75 * whole) ||
         (outlines.cut_off >= 8 && fraction < 0.45);
}

/// Says why the picture is no drawing on a background: nothing whole stands out, or next to nothing beside
/// what runs over the border.
std::optional<std::string> clutter(const Field& field, const Outlines& outlines) {
  const double diagonal = std::hypot(field.drawn.cols, field.drawn.rows);
  const double size = outlines.size_px;
  if (outlines.contours.empty())
    return outlines.cut_off > 0 ? kAllCutOff : "nothing in the picture stands out";
  if (size < std::max(12.0, 0.02 * diagonal)) {
    return fmt::format(
        "the largest whole shape is only {:.0f} px across; nothing stands out from the background", size);
  }
  if (const int specks = specks_in(field, outlines, size); specks > kMaxSpecks && size < 0.4 * diagonal) {
    return fmt::format(
        "the picture is full of specks ({}, none larger than {:.0f} px): noise or texture, no drawing",
        specks, size);
  }
  double fraction = 0.0;
  if (is_texture(field, outlines, fraction)) {
    return fmt::format(
        "{} shapes run over the picture's border and the largest whole one covers {:.0f} % of what is drawn: "
        "noise or texture, no drawing",
        outlines.cut_off, 100.0 * fraction);
  }
  if (outlines.cut_off == 0 || size > 0.2 * diagonal) return std::nullopt;
  double whole = 0.0;
  for (const double area : outlines.areas_px) whole += std::max(0.0, area);
  if (cv::countNonZero(field.drawn) < 4.0 * whole) return std::nullopt;
  return fmt::format(
      "most of what is drawn runs over the picture's border and the largest whole shape is only {:.0f} px "
      "across; show the shape with background all around it",
      size);
}

Separation judged(Field field) {
  Separation out;
  out.field = std::move(field);
  out.outlines = outlines_of(out.field);
  out.complaint = clutter(out.field, out.outlines);
  out.edges = edge_evidence(out.field);
  out.stands_out = out.outlines.size_px >= 0.2 * std::hypot(out.field.drawn.cols, out.field.drawn.rows);
  return out;
}

constexpr double kExplained = 0.95;  ///< a separation that explains more edges leaves none over

/// The level that explains most edges, if it does explain them. Among texture some level always leaves a
/// shape over: where the first one found no drawing, few shapes may be left.
std::optional<Separation> by_level(const Separation& first) {
  constexpr std::ptrdiff_t kFew = 8;
  Separation found = judged(at_explaining_level(first.field));
  if (!found.whole() || found.edges.explained <= kExplained) return std::nullopt;
  const auto& contours = found.outlines.contours;
  const auto rivals = std::count_if(contours.begin(), contours.end(), [&](const PixelContour& c) {
    return size_px(c) > 0.1 * found.outlines.size_px;
  });
  if (first.complaint && rivals > kFew) return std::nullopt;
  return found;
}

/// Lines on paper whose light changes at once, wide ones and thin ones.
std::vector<Separation> across_shadows(const cv::Mat& grey) {
  constexpr int kWideLines = 160;
  constexpr int kThinLines = 480;
  std::vector<Separation> out;
  for (const int small_side : {kWideLines, kThinLines}) {
    auto field = make_field(without_shadows(grey, small_side));
    if (!field) continue;
    Separation found = judged(std::move(*field));
    found.flattened = true;
    if (found.whole() && found.outlines.thin()) out.push_back(std::move(found));
  }
  return out;
}

/// What is fainter than half of the drawing is drawn too.
Separation with_fainter(Separation first) {
  constexpr double kWorthALook = 0.02;  // edges, beside one of the drawing
  if (first.edges.fainter < kWorthALook) return first;
  first.fainter = fainter_parts(first.field, first.outlines);
  if (first.fainter)
    first.explained_with_fainter = explained_by_either(first.field, first.fainter->field.level);
  return first;
}

/// Half of the paper in a deep shadow looks like the background, and the lit half like what is drawn: most of
/// that runs over the border, and the lines lie off the background to the other side. Lines on paper whose
/// light was evened out, if they leave nothing over.
std::optional<Separation> lines_in_half_shadow(const Separation& first, const cv::Mat& grey) {
  constexpr double kOtherSide = 0.2;  // edges, beside one of what is drawn
  constexpr double kMostOf = 2.0;     // what is drawn over what of it is whole
  if (first.edges.opposite < kOtherSide || first.outlines.cut_off == 0) return std::nullopt;
  double whole = 0.0;
  for (const double area : first.outlines.areas_px) whole += std::max(0.0, area);
  if (cv::countNonZero(first.field.drawn) < kMostOf * whole) return std::nullopt;
  std::optional<Separation> best;
  for (Separation& lines : across_shadows(grey)) {
    if (lines.outlines.cut_off > 0 || lines.edges.explained <= kExplained ||
        lines.edges.opposite > kOtherSide || (best && best->edges.explained >= lines.edges.explained))
      continue;
    best = std::move(lines);
  }
  return best;
}

/// The other way round: a lit plate in a dark frame.
std::optional<Separation> in_frame(const Field& field) {
  if (!frames(field.drawn)) return std::nullopt;
  Separation found = judged(inverted(field));
  if (!found.whole()) return std::nullopt;
  return found;
}

}  // namespace

tl::expected<Separation, std::string> separated(const cv::Mat& grey) {
  auto field = make_field(grey);
  if (!field) return tl::unexpected(field.error());
  Separation first = judged(std::move(*field));
  if (!first.complaint && first.edges.explained > kExplained) {
    auto lines = lines_in_half_shadow(first, grey);
    return with_fainter(lines ? std::move(*lines) : std::move(first));
  }
  const auto complaint = first.complaint;
  std::vector<Separation> candidates;
  auto level = by_level(first);
  // Lines where a level sees a region are its rim; lines the other way round the gaps between its lines.
  if (!level || level->outlines.thin()) candidates = across_shadows(grey);
  if (level) {
    std::erase_if(candidates, [&](const Separation& lines) { return lines.field.dark != level->field.dark; });
    candidates.push_back(std::move(*level));
  } else if (!complaint) {
    candidates.push_back(std::move(first));
  } else if (auto plate = in_frame(first.field)) {
    candidates.push_back(std::move(*plate));
  }
  if (candidates.empty()) return tl::unexpected(*complaint);
  return with_fainter(std::move(
      *std::max_element(candidates.begin(), candidates.end(),
                        [](const Separation& a, const Separation& b) { return a.score() < b.score(); })));
}

tl::expected<Separation, std::string> separated_at(const cv::Mat& grey, double share) {
  auto field = make_field(grey);
  if (!field) return tl::unexpected(field.error());
  Separation out = judged(at_share(*field, share));
  if (out.complaint)
    return tl::unexpected(
        fmt::format("level = {:.2f}: {}; another level may show it", share, *out.complaint));
  return out;
}

}  // namespace telekerf::vision
