// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/extract.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/extraction/corners.h"
#include "common/vision/extraction/thesis_tracker.h"
#include "common/vision/raster/shadow.h"

namespace telekerf::vision {
namespace {

constexpr std::array<std::pair<Mode, std::string_view>, 4> kNames{{{Mode::kAuto, "auto"},
                                                                   {Mode::kThesis, "thesis"},
                                                                   {Mode::kOutline, "outline"},
                                                                   {Mode::kStroke, "stroke"}}};
constexpr double kSmallestLengthPx = 16.0;
constexpr const char* kCutOff =
    "every shape touches the picture's border, so none is whole; show the shape with background all around "
    "it";

double size_of(const PixelContour& contour) {
  return geometry::bounding_box(contour.points_px).size().norm();
}

constexpr int kMostSpecks = 60;

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

constexpr double kThinnest =
    0.075;  ///< a drawing whose line is thinner than this share of its size is a stroke

/// Most of the picture's border is drawn.
bool frames(const cv::Mat& drawn) {
  const int last_row = drawn.rows - 1;
  const int last_column = drawn.cols - 1;
  const int along = cv::countNonZero(drawn.row(0)) + cv::countNonZero(drawn.row(last_row)) +
                    cv::countNonZero(drawn.col(0)) + cv::countNonZero(drawn.col(last_column));
  return along > drawn.rows + drawn.cols;
}

/// Shapes as thin as the filter lets them be, none of which stands out among the others.
int specks_in(const Field& field, const Outlines& outlines, double largest) {
  if (outlines.width_px > 2.0 * field.sigma_px + 1.5) return 0;
  return static_cast<int>(std::count_if(outlines.contours.begin(), outlines.contours.end(),
                                        [&](const PixelContour& c) { return size_of(c) > 0.3 * largest; }));
}

/// Texture has no end at the picture's border and no shape that stands out: the largest one covers little of
/// what is drawn, and little of what is whole.
bool is_texture(const Field& field, const Outlines& outlines, double& share) {
  double whole = 0.0;
  double largest = 0.0;
  for (const double area : outlines.areas_px) {
    whole += std::max(0.0, area);
    largest = std::max(largest, area);
  }
  share = largest / std::max(1, cv::countNonZero(field.drawn));
  return (outlines.cut_off >= 3 && share < 0.35 && largest < 0.75 * whole) ||
         (outlines.cut_off >= 8 && share < 0.45);
}

/// Says why the picture is no drawing on a background: nothing whole stands out, or next to nothing beside
/// what runs over the border.
std::optional<std::string> clutter(const Field& field, const Outlines& outlines) {
  const double diagonal = std::hypot(field.drawn.cols, field.drawn.rows);
  const double size = outlines.size_px;
  if (outlines.contours.empty()) return outlines.cut_off > 0 ? kCutOff : "nothing in the picture stands out";
  if (size < std::max(12.0, 0.02 * diagonal)) {
    return fmt::format(
        "the largest whole shape is only {:.0f} px across; nothing stands out from the background", size);
  }
  if (const int specks = specks_in(field, outlines, size); specks > kMostSpecks && size < 0.4 * diagonal) {
    return fmt::format(
        "the picture is full of specks ({}, none larger than {:.0f} px): noise or texture, no drawing",
        specks, size);
  }
  double share = 0.0;
  if (is_texture(field, outlines, share)) {
    return fmt::format(
        "{} shapes run over the picture's border and the largest whole one covers {:.0f} % of what is drawn: "
        "noise or texture, no drawing",
        outlines.cut_off, 100.0 * share);
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

/// One way to tell drawing from background, and what speaks for it.
struct Separation {
  Field field;
  Outlines outlines;
  std::optional<std::string> complaint;
  double explained = 0.0;   ///< share of the sharp edges
  bool stands_out = false;  ///< large enough to be what the picture is about

  bool whole() const { return !complaint && stands_out; }
  bool thin() const { return outlines.width_px < kThinnest * outlines.size_px; }
  double score() const { return explained * field.contrast; }  ///< many edges on a clear border
};

Separation judged(Field field) {
  Separation out{std::move(field), {}, {}};
  out.outlines = outlines_of(out.field);
  out.complaint = clutter(out.field, out.outlines);
  out.explained = explained_edges(out.field);
  out.stands_out = out.outlines.size_px >= 0.2 * std::hypot(out.field.drawn.cols, out.field.drawn.rows);
  return out;
}

constexpr double kExplained = 0.95;  ///< a separation that explains more edges leaves none over

/// The level that explains most edges, if it does explain them. Among texture some level always leaves a
/// shape over: where the first one found no drawing, few shapes may be left.
std::optional<Separation> by_level(const Separation& first) {
  constexpr std::ptrdiff_t kFew = 8;
  Separation found = judged(at_explaining_level(first.field));
  if (!found.whole() || found.explained <= kExplained) return std::nullopt;
  const auto& contours = found.outlines.contours;
  const auto rivals = std::count_if(contours.begin(), contours.end(), [&](const PixelContour& c) {
    return size_of(c) > 0.1 * found.outlines.size_px;
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
    if (found.whole() && found.thin()) out.push_back(std::move(found));
  }
  return out;
}

/// The other way round: a lit plate in a dark frame.
std::optional<Separation> in_frame(const Field& field) {
  if (!frames(field.drawn)) return std::nullopt;
  Separation found = judged(inverted(field));
  if (!found.whole()) return std::nullopt;
  return found;
}

/// Drawing and background of a picture. Where the first level finds no whole drawing or leaves sharp edges
/// over, a better one if there is any, or lines across shadows, whichever scores best.
tl::expected<Separation, std::string> separated(const cv::Mat& grey) {
  auto field = make_field(grey);
  if (!field) return tl::unexpected(field.error());
  Separation first = judged(std::move(*field));
  if (!first.complaint && first.explained > kExplained) return first;
  const auto complaint = first.complaint;
  std::vector<Separation> candidates;
  auto level = by_level(first);
  // Lines where a level sees a region are its rim; lines the other way round the gaps between its lines.
  if (!level || level->thin()) candidates = across_shadows(grey);
  if (level) {
    std::erase_if(candidates, [&](const Separation& lines) { return lines.field.dark != level->field.dark; });
    candidates.push_back(std::move(*level));
  } else if (!complaint) {
    candidates.push_back(std::move(first));
  } else if (auto plate = in_frame(first.field)) {
    candidates.push_back(std::move(*plate));
  }
  if (candidates.empty()) return tl::unexpected(*complaint);
  return std::move(
      *std::max_element(candidates.begin(), candidates.end(),
                        [](const Separation& a, const Separation& b) { return a.score() < b.score(); }));
}

tl::expected<Contours, std::string> finished(Contours contours, double smallest_share, double sigma_px,
                                             const char* complaint) {
  keep_large(contours, smallest_share);
  if (contours.empty()) return tl::unexpected<std::string>(complaint);
  for (PixelContour& contour : contours) smooth_and_resample(contour, sigma_px);
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
                                                 const ExtractSettings& settings) {
  const double blur_px = blur_of(field, found.contours);
  for (std::size_t i = 0; i < found.contours.size(); ++i) found.contours[i].hole = found.areas_px[i] < 0.0;
  auto contours =
      finished(std::move(found.contours), settings.smallest_share, 1.0,
               found.cut_off > 0 ? kCutOff : "the picture holds specks only, no shape with an outline");
  if (contours) {
    for (PixelContour& contour : *contours) {
      move_to_local_level(field, blur_px, contour.points_px);
      sharpen_corners(contour.points_px, true, {.blur_px = blur_px});
    }
  }
  return contours;
}

tl::expected<Contours, std::string> stroke_mode(const Field& field, const Outlines& found,
                                                const ExtractSettings& settings) {
  return finished(strokes_of(field, found), settings.smallest_share, 1.0,
                  found.cut_off > 0 ? kCutOff : "the picture holds specks only, no stroke");
}

tl::expected<Contours, std::string> thesis_mode(const Field& field, const Outlines& found,
                                                const ExtractSettings& settings) {
  const double width = found.width_px;
  const bool is_stroke = width < kThinnest * std::max(1.0, found.size_px);
  const cv::Mat band = edge_band(field, width, is_stroke);
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
      finished(std::move(out), settings.smallest_share, 1.0,
               "the window found too little to follow from its start; give --start on the contour");
  if (contours && !is_stroke) {
    sharpen_corners(contours->front().points_px, contours->front().closed, {.blur_px = blur_px});
  }
  return contours;
}

/// The part between two points of a contour; without `end` only the start moves. An end that is nearly meant
/// is kept whole.
void apply_ends(Contours& contours, const std::optional<Vec2>& start, const std::optional<Vec2>& end) {
  if (!start && !end) return;
  const auto nearest = [](const PixelContour& c, const Vec2& p) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < c.points_px.size(); ++i) {
      if ((c.points_px[i] - p).squaredNorm() < (c.points_px[best] - p).squaredNorm()) best = i;
    }
    return best;
  };
  // The contour that the first given point lies on comes first.
  const Vec2 wanted = start ? *start : *end;
  const auto distance = [&](const PixelContour& c) {
    return (c.points_px[nearest(c, wanted)] - wanted).norm();
  };
  const auto chosen = std::min_element(contours.begin(), contours.end(), [&](const auto& a, const auto& b) {
    return distance(a) + 1e-6 < distance(b);
  });
  std::rotate(contours.begin(), chosen, chosen + 1);
  PixelContour& c = contours.front();
  auto& p = c.points_px;
  const auto near = static_cast<std::size_t>(1.5 * c.width_px + 5.0);
  if (c.closed) {
    if (start) std::rotate(p.begin(), p.begin() + nearest(c, *start), p.end());
    if (!start || !end) return;
    const std::size_t last = nearest(c, *end);
    if (last <= near || last + near >= p.size()) return;  // all the way round
    // Of the two ways round, the longer one leaves less undone.
    if (2 * last < p.size()) {
      std::reverse(p.begin() + 1, p.end());
      p.resize(p.size() - last + 1);
    } else {
      p.resize(last + 1);
    }
    c.closed = false;
    return;
  }
  std::size_t first = start ? nearest(c, *start) : 0;
  std::size_t last = end ? nearest(c, *end) : p.size() - 1;
  if (start && !end && 2 * first > p.size()) last = 0;
  if (end && !start && 2 * last < p.size()) first = p.size() - 1;
  if (first > last) {
    std::reverse(p.begin(), p.end());
    first = p.size() - 1 - first;
    last = p.size() - 1 - last;
  }
  if (last + near < p.size()) p.resize(last + 1);
  if (first > near) p.erase(p.begin(), p.begin() + first);
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
  auto found = separated(*grey);
  if (!found) return tl::unexpected(found.error());
  Field& field = found->field;
  Outlines& outlines = found->outlines;

  Extraction out;
  out.picture_width_px = image.cols;
  out.picture_height_px = image.rows;
  out.contrast = field.contrast;
  out.noise = field.noise;
  out.mode = settings.mode;
  out.why = "asked for";
  if (settings.mode == Mode::kAuto) {
    const double width = outlines.width_px;
    const double size = std::max(1.0, outlines.size_px);
    out.mode = width < kThinnest * size ? Mode::kStroke : Mode::kOutline;
    out.why = fmt::format("what is drawn is {:.1f} px wide and {:.0f} px across: a {}", width, size,
                          out.mode == Mode::kStroke ? "stroke" : "region");
  }
  auto contours = out.mode == Mode::kStroke   ? stroke_mode(field, outlines, settings)
                  : out.mode == Mode::kThesis ? thesis_mode(field, outlines, settings)
                                              : outline_mode(field, std::move(outlines), settings);
  if (!contours) return tl::unexpected(contours.error());
  out.contours = std::move(*contours);
  apply_ends(out.contours, settings.start_px, settings.end_px);
  if (out.contours.front().points_px.size() < 4) {
    return tl::unexpected<std::string>(
        "start and end lie so close together that nothing is left between them");
  }
  return out;
}

}  // namespace telekerf::vision
