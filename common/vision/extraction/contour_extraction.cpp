// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/contour_extraction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "common/vision/extraction/border.h"
#include "common/vision/extraction/centre_line.h"
#include "common/vision/extraction/corners.h"
#include "common/vision/extraction/edge_band.h"
#include "common/vision/extraction/ends.h"
#include "common/vision/extraction/local_level.h"
#include "common/vision/extraction/separation.h"
#include "common/vision/extraction/shapes.h"
#include "common/vision/extraction/stroke.h"
#include "common/vision/extraction/surroundings.h"
#include "common/vision/extraction/thesis_tracker.h"
#include "common/vision/raster/grey_plane.h"
#include "common/vision/raster/levels.h"

namespace telekerf::vision {
namespace {

constexpr double kMinLength_px = 16.0;
constexpr double kMinAskedLength_px = 8.0;  ///< where the smallest size is asked for
constexpr double kNoise_px = 5.0;           ///< smaller ones are not worth a word

/// Largest first; specks go.
void keep_large(Contours& contours, const ExtractionSettings& settings, SmallParts& left_out) {
  std::vector<std::pair<double, std::size_t>> order;
  const double min_length = settings.min_size_px ? kMinAskedLength_px : kMinLength_px;
  std::vector<double> small;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const double size = size_px(contours[i]);
    if (length_px(contours[i]) < min_length) {
      small.push_back(size);
    } else {
      order.emplace_back(size, i);
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  Contours kept;
  for (const auto& [size, i] : order) {
    const double min_size = settings.min_size_px.value_or(settings.min_size_fraction * order.front().first);
    if (size >= min_size) {
      kept.push_back(std::move(contours[i]));
    } else {
      small.push_back(size);
    }
  }
  for (const double size : small) {
    if (size < kNoise_px) continue;
    ++left_out.small;
    left_out.largest_px = std::max(left_out.largest_px, size);
  }
  contours = std::move(kept);
}

tl::expected<Contours, std::string> finished(Contours contours, const ExtractionSettings& settings,
                                             SmallParts& left_out, const char* complaint) {
  keep_large(contours, settings, left_out);
  if (contours.empty()) return tl::unexpected<std::string>(complaint);
  for (PixelContour& contour : contours) smooth_and_resample(contour, 1.0);
  return contours;
}

/// Sigma of lens and filter together, from how steep the picture is along the borders.
double blur_of(const Field& field, const Contours& contours) {
  std::vector<double> slopes;
  std::size_t points = 0;
  for (const PixelContour& c : contours) points += c.points_px.size();
  const std::size_t step = points / 2000 + 1;
  std::size_t next = 0;
  for (const PixelContour& c : contours) {
    for (; next < c.points_px.size(); next += step) {
      const int x = static_cast<int>(std::lround(c.points_px[next].x()));
      const int y = static_cast<int>(std::lround(c.points_px[next].y()));
      if (x < 1 || y < 1 || x + 1 >= field.smooth.cols || y + 1 >= field.smooth.rows) continue;
      slopes.push_back(0.5 * std::hypot(field.value(x + 1, y) - field.value(x - 1, y),
                                        field.value(x, y + 1) - field.value(x, y - 1)));
    }
    next -= c.points_px.size();
  }
  if (slopes.empty()) return field.sigma_px;
  std::nth_element(slopes.begin(), slopes.begin() + slopes.size() / 2, slopes.end());
  const double slope = std::max(1e-3, slopes[slopes.size() / 2]);
  return std::clamp(field.contrast / (std::sqrt(2.0 * M_PI) * slope), field.sigma_px, 5.0);
}

tl::expected<Contours, std::string> outline_mode(const Field& field, Outlines found,
                                                 const ExtractionSettings& settings, SmallParts& left_out) {
  const double blur_px = blur_of(field, found.contours);
  for (std::size_t i = 0; i < found.contours.size(); ++i) found.contours[i].hole = found.areas_px[i] < 0.0;
  auto contours =
      finished(std::move(found.contours), settings, left_out,
               found.cut_off > 0 ? kAllCutOff : "the picture holds specks only, no shape with an outline");
  if (contours) {
    for (PixelContour& contour : *contours) {
      if (!settings.level) move_to_local_level(field, blur_px, contour.points_px);
      sharpen_corners(contour.points_px, true, {.blur_px = blur_px});
    }
  }
  return contours;
}

/// The outlines of what no stroke runs through: dots beside lines.
Contours dots_beside(const Contours& strokes, const Outlines& found, const cv::Size& picture) {
  constexpr double kSlender = 0.15;  // width over size: what is larger and more slender has a stroke
  constexpr double kLarge_px = 40.0;
  std::vector<std::size_t> stout;
  for (std::size_t i = 0; i < found.contours.size(); ++i) {
    const PixelContour& shape = found.contours[i];
    const double size = size_px(shape);
    if (found.areas_px[i] <= 0.0 || size < kNoise_px) continue;
    if (size < kLarge_px || 2.0 * found.areas_px[i] > kSlender * size * length_px(shape)) stout.push_back(i);
  }
  if (stout.empty()) return {};
  cv::Mat along(picture, CV_8U, cv::Scalar(0));
  for (const PixelContour& stroke : strokes) {
    if (length_px(stroke) < kMinAskedLength_px) continue;
    for (const Vec2& p : stroke.points_px)
      along.at<unsigned char>(std::clamp(static_cast<int>(std::lround(p.y())), 0, picture.height - 1),
                              std::clamp(static_cast<int>(std::lround(p.x())), 0, picture.width - 1)) = 255;
  }
  Contours out;
  for (const std::size_t i : stout) {
    const geometry::Box box = geometry::bounding_box(found.contours[i].points_px);
    const cv::Rect held =
        cv::Rect(cv::Point(static_cast<int>(box.min.x()), static_cast<int>(box.min.y())),
                 cv::Point(static_cast<int>(box.max.x()) + 2, static_cast<int>(box.max.y()) + 2)) &
        cv::Rect({}, picture);
    if (cv::countNonZero(along(held)) == 0) out.push_back(found.contours[i]);
  }
  return out;
}

tl::expected<Contours, std::string> stroke_mode(const Field& field, const Outlines& found,
                                                const ExtractionSettings& settings, SmallParts& left_out) {
  Contours all = strokes_of(field, found);
  if (std::any_of(all.begin(), all.end(), [](const auto& c) { return length_px(c) >= kMinLength_px; })) {
    Contours dots = dots_beside(all, found, field.drawn.size());
    std::erase_if(all, [](const auto& c) { return length_px(c) < kMinAskedLength_px; });  // within the dots
    std::move(dots.begin(), dots.end(), std::back_inserter(all));
  }
  return finished(std::move(all), settings, left_out,
                  found.cut_off > 0 ? kAllCutOff : "the picture holds specks only, no stroke");
}

tl::expected<Contours, std::string> thesis_mode(const Field& field, const Outlines& found,
                                                const ExtractionSettings& settings, SmallParts& left_out) {
  const double width = found.width_px;
  const bool is_stroke = found.thin();
  const cv::Mat band = edge_band(field, width, is_stroke, settings.level.value_or(kHalfWay));
  std::optional<cv::Point> start = first_in_evolving_square(band);
  if (!start) return tl::unexpected<std::string>("Canny finds no edge in the picture");
  if (settings.start_px) {
    std::vector<cv::Point> on;
    cv::findNonZero(band > 0.2F, on);
    for (const cv::Point& p : on) {
      const auto distance = [&](const cv::Point& q) {
        return (Vec2(q.x, q.y) - *settings.start_px).squaredNorm();
      };
      if (distance(p) < distance(*start)) start = p;
    }
  }
  const Route route = follow_band(band, *start, is_stroke ? width : 3.0, is_stroke);
  Contours out{is_stroke ? centred(field, route, width) : on_border(field, route)};
  const double blur_px = blur_of(field, out);
  auto contours =
      finished(std::move(out), settings, left_out,
               "the window found too little to follow from its start; give --start on the contour");
  if (contours && !is_stroke) {
    sharpen_corners(contours->front().points_px, contours->front().closed, {.blur_px = blur_px});
  }
  return contours;
}

/// Strokes by their centre lines, regions by their outlines; largest first.
tl::expected<Contours, std::string> both_modes(const Field& field, ShapeKinds kinds,
                                               const ExtractionSettings& settings, SmallParts& left_out) {
  Field ink = field;
  ink.drawn = kinds.stroke_ink;
  auto strokes = stroke_mode(ink, kinds.strokes, settings, left_out);
  auto regions = outline_mode(field, std::move(kinds.regions), settings, left_out);
  if (!strokes) return regions;
  if (!regions) return strokes;
  strokes->insert(strokes->end(), std::make_move_iterator(regions->begin()),
                  std::make_move_iterator(regions->end()));
  keep_large(*strokes, settings, left_out);
  return strokes;
}

/// Looked at in some pixels only.
DrawingEvidence evidence_of(const Separation& found) {
  constexpr int kClear_px = 3;  // from what is drawn
  const cv::Mat& drawn = found.fainter ? found.fainter->darker : found.field.drawn;
  const cv::Mat* const fainter = found.fainter ? &found.fainter->field.drawn : nullptr;
  const int step = std::max(4, std::min(drawn.rows, drawn.cols) / 120);
  Histogram paper{};
  Histogram beside{};
  Histogram ink{};
  double inked = 0.0;
  for (int y = kClear_px; y + kClear_px < drawn.rows; y += step) {
    const auto near = [&](const cv::Mat& plane, int x) {
      const auto* here = plane.ptr<unsigned char>(y);
      return here[x - kClear_px] | here[x + kClear_px] | here[x] | plane.at<unsigned char>(y - kClear_px, x) |
             plane.at<unsigned char>(y + kClear_px, x);
    };
    const auto* here = drawn.ptr<unsigned char>(y);
    const auto* grey = found.field.smooth.ptr<unsigned char>(y);
    for (int x = kClear_px; x + kClear_px < drawn.cols; x += step) {
      if (here[x] != 0) {
        inked += 1.0;
        ink[grey[x]] += 1.0;
      }
      if (near(drawn, x) != 0) continue;
      paper[grey[x]] += 1.0;
      if (fainter == nullptr || near(*fainter, x) == 0) beside[grey[x]] += 1.0;
    }
  }
  double whole = 0.0;
  for (const double area : found.outlines.areas_px) whole += area;
  const auto range = [&](const Histogram& counts) {
    return (percentile(counts, 0, 255, 0.9) - percentile(counts, 0, 255, 0.1)) /
           std::max(1.0, found.field.contrast);
  };
  DrawingEvidence out;
  out.explained = found.edges.explained;
  out.explained_with_fainter = found.explained_with_fainter;
  out.opposite = found.edges.opposite;
  out.fainter = found.fainter.has_value();
  out.flattened = found.flattened;
  out.unevenness = range(paper);
  out.unevenness_beside = range(beside);
  out.ink_range = range(ink);
  out.cut_off = found.outlines.cut_off;
  out.one_pen = out.cut_off < 3 || !found.outlines.thin() || is_of_one_pen(found.field, found.outlines);
  out.cut_off_share =
      out.cut_off == 0 ? 0.0 : std::max(0.0, 1.0 - whole / std::max(1.0, inked * step * step));
  return out;
}

/// Each shape in its mode; says in `out` which that is and why.
tl::expected<Contours, std::string> followed(const Field& field, Outlines outlines,
                                             const ExtractionSettings& settings, Extraction& out) {
  out.mode = settings.mode;
  out.why = settings.level ? fmt::format("level {:.2f} asked for", *settings.level) : "asked for";
  ShapeKinds kinds;
  if (settings.mode == ExtractionMode::kAuto) {
    kinds = kinds_of(field, outlines);
    const bool strokes = !kinds.strokes.contours.empty();
    const bool regions = !kinds.regions.contours.empty();
    const double size = std::max(1.0, outlines.size_px);
    const bool mostly_strokes = strokes && (!regions || kinds.strokes.size_px >= kinds.regions.size_px);
    out.mode = mostly_strokes ? ExtractionMode::kStroke : ExtractionMode::kOutline;
    out.why = fmt::format("what is drawn is {:.1f} px wide and {:.0f} px across: a {}", outlines.width_px,
                          size, mostly_strokes ? "stroke" : "region");
    if (strokes && regions) out.why += mostly_strokes ? ", and regions beside it" : ", and strokes beside it";
  }
  if (!kinds.strokes.contours.empty() && !kinds.regions.contours.empty())
    return both_modes(field, std::move(kinds), settings, out.left_out);
  switch (out.mode) {
    case ExtractionMode::kStroke:
      return stroke_mode(field, outlines, settings, out.left_out);
    case ExtractionMode::kThesis:
      return thesis_mode(field, outlines, settings, out.left_out);
    case ExtractionMode::kAuto:
    case ExtractionMode::kOutline:
      break;
  }
  return outline_mode(field, std::move(outlines), settings, out.left_out);
}

}  // namespace

tl::expected<Extraction, std::string> extract(const cv::Mat& image, const ExtractionSettings& settings) {
  const auto grey = grey_plane(image);
  if (!grey) return tl::unexpected(grey.error());
  auto found = settings.level ? separated_at(*grey, *settings.level) : separated(*grey);
  std::string cleared;
  cv::Mat hidden;
  if (!settings.level &&
      (settings.mode == ExtractionMode::kAuto || settings.mode == ExtractionMode::kOutline ||
       settings.mode == ExtractionMode::kStroke)) {
    auto without = on_sheet(*grey, found);
    if (!without && settings.mode != ExtractionMode::kStroke) without = under_hair(*grey, found);
    if (without) {
      found = std::move(without->found);
      cleared = "; " + without->what;
      hidden = without->hidden;
    }
  }
  if (!found) return tl::unexpected(found.error());
  Field field = found->field;
  Outlines& outlines = found->outlines;

  Extraction out;
  out.picture_width_px = image.cols;
  out.picture_height_px = image.rows;
  out.contrast = field.contrast;
  out.noise = field.noise;
  out.evidence = evidence_of(*found);
  out.evidence.cleared = !hidden.empty();
  if (found->fainter) field.contrast = found->fainter->step;
  auto contours = outlines.contours.empty()  // all of it is fainter in part
                      ? tl::expected<Contours, std::string>(Contours{})
                      : followed(field, std::move(outlines), settings, out);
  if (found->fainter && settings.mode != ExtractionMode::kThesis) {
    FainterParts& more = *found->fainter;
    const bool alone = contours && contours->empty();
    Extraction beside;
    auto fainter = followed(more.field, std::move(more.outlines), settings, beside);
    if (alone) {
      out.mode = beside.mode == ExtractionMode::kAuto ? out.mode : beside.mode;
      out.why = beside.why;
      out.left_out = beside.left_out;
      contours = std::move(fainter);
    } else if (contours && fainter) {
      contours->insert(contours->end(), std::make_move_iterator(fainter->begin()),
                       std::make_move_iterator(fainter->end()));
      out.left_out.add(beside.left_out);
      keep_large(*contours, settings, out.left_out);
    }
  }
  if (!contours) return tl::unexpected(contours.error());
  out.why += cleared;
  if (out.evidence.cut_off > 0) {
    out.why +=
        fmt::format("; {} that touch{} the picture's border left out (--at X,Y takes one of them)",
                    out.evidence.cut_off == 1 ? "1 shape" : fmt::format("{} shapes", out.evidence.cut_off),
                    out.evidence.cut_off == 1 ? "es" : "");
  }
  out.contours = std::move(*contours);
  if (!hidden.empty()) {
    for (PixelContour& contour : out.contours)
      if (contour.closed && contour.width_px == 0.0) lead_through(hidden, contour);
  }
  apply_ends(out.contours, settings.start_px, settings.end_px);
  if (out.contours.front().points_px.size() < 4) {
    return tl::unexpected<std::string>(
        "start and end lie so close together that nothing is left between them");
  }
  return out;
}

}  // namespace telekerf::vision
