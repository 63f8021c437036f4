// SPDX-License-Identifier: Apache-2.0
#include "common/vision/picture_contours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/vision/extraction/dashes.h"
#include "common/vision/extraction/ends.h"
#include "common/vision/raster/field.h"
#include "common/vision/raster/grey_plane.h"
#include "common/vision/segmentation/snapping.h"
#include "common/vision/segmentation/things.h"

namespace telekerf::vision {
namespace {

constexpr int kThings_px = 480;   ///< longer side of the scene that things are looked for in
constexpr int kPointed_px = 360;  ///< cutting out costs more
constexpr const char* kRemedy =
    "point at the thing to be cut: --at X,Y (a pixel inside), or --box X,Y,WIDTH,HEIGHT around it";

/// A picture of one ink on one paper: nearly all sharp edges lie on the contours, and the paper is even.
bool is_sure(const Extraction& drawing) {
  const DrawingEvidence& e = drawing.evidence;
  // Two tones on even paper, each of next to one grey; a photograph has many.
  constexpr std::size_t kFew = 24;
  if (e.fainter && e.explained_with_fainter > 0.95 && e.unevenness_beside < 0.05 && e.ink_range < 0.9 &&
      e.cut_off == 0 && drawing.contours.size() <= kFew)
    return true;
  // Edges of what was cleared away are still explained by nothing.
  if (e.cleared && e.unevenness < 0.15 && e.ink_range < 0.5) return e.explained > 0.5;
  // The lit half of paper in shadow: most of what is drawn runs over the border, and lines lie on its other
  // side.
  if (e.cut_off > 0 && e.cut_off_share > 0.5 && e.opposite > 0.2) return false;
  if (!e.one_pen || (e.cut_off >= 3 && e.cut_off_share > 0.35)) return false;
  // Even ink under a faint shadow, whose own edge is explained by nothing.
  if (e.cut_off == 0 && e.ink_range < 0.12 && e.unevenness < 0.45 && e.explained > 0.75) return true;
  if (e.explained >= 0.99) return e.unevenness < 0.36;
  if (e.explained < 0.97 && e.ink_range > 1.0) return false;
  return e.explained >= 0.9 && e.unevenness < 0.2;
}

/// What of the pointing lies beyond the picture.
std::optional<std::string> beyond(const Pointing& pointing, const cv::Mat& picture) {
  const auto inside = [&](const Vec2& p) {
    return p.x() >= -0.5 && p.y() >= -0.5 && p.x() < picture.cols && p.y() < picture.rows;
  };
  const auto sentence = [&](const char* flag, const Vec2& p) {
    return fmt::format("{} {:.0f},{:.0f} lies beyond the picture, which has {} x {} pixels", flag, p.x(),
                       p.y(), picture.cols, picture.rows);
  };
  for (const Vec2& p : pointing.at)
    if (!inside(p)) return sentence("--at", p);
  for (const Vec2& p : pointing.away)
    if (!inside(p)) return sentence("--not", p);
  if (pointing.box && !inside(pointing.box->head<2>())) return sentence("--box", pointing.box->head<2>());
  return std::nullopt;
}

/// A colour that most of what is not drawn on the picture's border has; nothing if there is none.
std::optional<cv::Scalar> border_colour(const cv::Mat& image) {
  constexpr double kMost = 0.55;  // of the border
  constexpr int kNear = 3;
  const cv::Mat bgr = colour_plane(image);
  if (bgr.empty()) return std::nullopt;
  std::vector<std::vector<cv::Vec3b>> sides(4);
  for (int x = 0; x < bgr.cols; ++x) {
    sides[0].push_back(bgr.at<cv::Vec3b>(0, x));
    sides[1].push_back(bgr.at<cv::Vec3b>(bgr.rows - 1, x));
  }
  for (int y = 0; y < bgr.rows; ++y) {
    sides[2].push_back(bgr.at<cv::Vec3b>(y, 0));
    sides[3].push_back(bgr.at<cv::Vec3b>(y, bgr.cols - 1));
  }
  const auto difference = [](const cv::Vec3b& a, const cv::Vec3b& b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
  };
  // A corner is background in nearly every trimmed picture.
  for (const cv::Vec3b& corner : {sides[0].front(), sides[0].back(), sides[1].front(), sides[1].back()}) {
    std::size_t alike = 0;
    std::size_t all = 0;
    bool touched = true;  // the drawing reaches all four sides
    for (const auto& side : sides) {
      bool here = false;
      for (const cv::Vec3b& p : side) {
        alike += difference(p, corner) <= kNear;
        here = here || difference(p, corner) > 40;
      }
      all += side.size();
      touched = touched && here;
    }
    if (touched && static_cast<double>(alike) > kMost * static_cast<double>(all))
      return cv::Scalar(corner[0], corner[1], corner[2]);
  }
  return std::nullopt;
}

/// A quarter of the border at least is transparent.
bool is_on_nothing(const cv::Mat& image) {
  if (image.channels() != 4) return false;
  cv::Mat alpha;
  cv::extractChannel(image, alpha, 3);
  double most = 0.0;
  cv::minMaxLoc(alpha, nullptr, &most);
  alpha = alpha < 0.5 * most;
  const int nothing = cv::countNonZero(alpha.row(0)) + cv::countNonZero(alpha.row(alpha.rows - 1)) +
                      cv::countNonZero(alpha.col(0)) + cv::countNonZero(alpha.col(alpha.cols - 1));
  return nothing > (alpha.rows + alpha.cols) / 2;
}

/// A drawing that was trimmed to its own size, with room put round it again: one on nothing (transparent), or
/// one on an even colour that reaches all four sides.
std::optional<Extraction> trimmed(const cv::Mat& image, const ExtractionSettings& settings) {
  constexpr double kMaxNoise = 1.5;  // grey levels: a photograph has more
  const auto grey = grey_plane(image);
  if (!grey || noise_of(*grey) > kMaxNoise) return std::nullopt;
  const int room = std::max(8, std::max(image.cols, image.rows) / 20);
  cv::Mat wide;
  const bool on_nothing = is_on_nothing(image);
  if (on_nothing) {
    cv::copyMakeBorder(image, wide, room, room, room, room, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  } else if (const auto colour = border_colour(image)) {
    cv::Mat bgr = colour_plane(image);
    cv::copyMakeBorder(bgr, wide, room, room, room, room, cv::BORDER_CONSTANT, *colour);
  } else {
    return std::nullopt;
  }
  const Vec2 shift = Vec2::Constant(room);
  ExtractionSettings moved = settings;
  if (moved.start_px) *moved.start_px += shift;
  if (moved.end_px) *moved.end_px += shift;
  auto out = extract(wide, moved);
  if (!out || out->evidence.cut_off > 0) return std::nullopt;
  // Where no transparency says so it must be one ink on one colour.
  if (!on_nothing &&
      (out->evidence.explained < 0.97 || out->evidence.unevenness > 0.05 || out->evidence.ink_range > 0.6))
    return std::nullopt;
  out->picture_width_px = image.cols;
  out->picture_height_px = image.rows;
  out->why += "; trimmed to its own size, so room was put round it";
  for (PixelContour& c : out->contours) {
    for (Vec2& p : c.points_px) p -= shift;
  }
  return std::move(*out);
}

Extraction extraction_of(const cv::Mat& image, const Scene& scene, const cv::Mat& mask, const cv::Mat& bgr,
                         const PictureRequest& request, std::string why) {
  Extraction out;
  out.mode = ExtractionMode::kOutline;
  out.why = std::move(why);
  out.picture_width_px = image.cols;
  out.picture_height_px = image.rows;
  out.contours = snapped_outlines(scene, mask, bgr);
  for (PixelContour& c : out.contours) smooth_and_resample(c, 1.0);
  std::stable_sort(out.contours.begin(), out.contours.end(),
                   [](const auto& a, const auto& b) { return size_px(a) > size_px(b); });
  if (!out.contours.empty()) apply_ends(out.contours, request.extraction.start_px, request.extraction.end_px);
  return out;
}

std::string why_of(const Things& things) {
  std::string out = "what stands out from its background";
  if (things.cut_off > 0) {
    out += fmt::format("; {} touching the picture's border left out (--at X,Y takes one of them)",
                       things.cut_off == 1 ? "1 thing" : fmt::format("{} things", things.cut_off));
  }
  if (things.small > 0) {
    out += fmt::format("; {} left out (--at X,Y takes one of them)",
                       things.small == 1 ? "1 small thing" : fmt::format("{} small things", things.small));
  }
  return out;
}

bool encloses(const PixelContour& contour, const Vec2& p) {
  if (!contour.closed) return false;
  bool inside = false;
  const auto& points = contour.points_px;
  for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
    const Vec2& a = points[i];
    const Vec2& b = points[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

/// Of a drawing only what the points lie on, or within, with the holes of a region. False: a point lies on
/// nothing, and all is kept.
bool keep_pointed_at(Extraction& drawing, const Pointing& pointing) {
  if (pointing.at.empty() || pointing.box) return false;
  std::vector<bool> keep(drawing.contours.size(), false);
  for (const Vec2& p : pointing.at) {
    std::optional<std::size_t> best;
    double least = 0.0;
    for (std::size_t i = 0; i < drawing.contours.size(); ++i) {
      const PixelContour& c = drawing.contours[i];
      double nearest = 1e9;
      for (const Vec2& q : c.points_px) nearest = std::min(nearest, (q - p).norm());
      const bool on_line = c.width_px > 0.0 && nearest < c.width_px + 3.0;
      if (!on_line && (c.hole || !encloses(c, p))) continue;
      const double rank =
          on_line ? nearest - 1e6 : size_px(c);  // a line that is hit, else the smallest shape
      if (best && rank >= least) continue;
      best = i;
      least = rank;
    }
    if (!best) return false;
    keep[*best] = true;
  }
  for (const Vec2& p : pointing.away) {
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (keep[i] && encloses(drawing.contours[i], p)) return false;
    }
  }
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const PixelContour& hole = drawing.contours[i];
    if (!hole.hole) continue;
    for (std::size_t k = 0; k < keep.size() && !keep[i]; ++k)
      keep[i] = keep[k] && !drawing.contours[k].hole && encloses(drawing.contours[k], hole.points_px.front());
  }
  Contours kept;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) kept.push_back(std::move(drawing.contours[i]));
  }
  drawing.contours = std::move(kept);
  drawing.why += "; the contour that is pointed at";
  return true;
}

/// What the drawing's outlines enclose, in the scene.
cv::Mat enclosed_by(const Extraction& drawing, const Scene& scene) {
  cv::Mat drawn(scene.lab.size(), CV_8U, cv::Scalar(0));
  for (const PixelContour& c : drawing.contours) {
    if (c.hole) continue;
    std::vector<cv::Point> polygon;
    for (const Vec2& p : c.points_px) {
      const Vec2 q = scene.to_scene(p);
      polygon.emplace_back(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y())));
    }
    cv::fillPoly(drawn, std::vector<std::vector<cv::Point>>{polygon}, cv::Scalar(255));
  }
  return drawn;
}

/// The drawing's outlines enclose what was cut out of the scene, nearly.
bool is_like(const Extraction& drawing, const Scene& scene, const cv::Mat& mask) {
  const cv::Mat drawn = enclosed_by(drawing, scene);
  return cv::countNonZero(drawn & mask) > 0.85 * cv::countNonZero(drawn | mask);
}

/// All of the drawing is among what was cut out of the scene.
bool holds(const Scene& scene, const cv::Mat& mask, const Extraction& drawing) {
  const cv::Mat drawn = enclosed_by(drawing, scene);
  return cv::countNonZero(drawn & mask) > 0.9 * cv::countNonZero(drawn);
}

}  // namespace

namespace {

tl::expected<Extraction, std::string> found_in(const cv::Mat& image, const PictureRequest& request) {
  const ExtractionMode mode = request.extraction.mode;
  if (request.extraction.level) {
    auto drawing = extract(image, request.extraction);
    if (drawing && request.pointing.any() && !keep_pointed_at(*drawing, request.pointing))
      return tl::unexpected(
          fmt::format("level = {:.2f}: no contour is there that is pointed at; leave out --at or "
                      "--box, or choose another level",
                      *request.extraction.level));
    return drawing;
  }
  if (request.pointing.any()) {
    if (mode == ExtractionMode::kStroke || mode == ExtractionMode::kThesis)
      return tl::unexpected(fmt::format("--at and --box find the outline of a thing; leave out --mode {}",
                                        kExtractionModes.word(mode)));
    const cv::Mat bgr = colour_plane(image);
    if (bgr.empty()) return tl::unexpected<std::string>("the picture is empty");
    if (const auto misfit = beyond(request.pointing, bgr)) return tl::unexpected(*misfit);
    const Scene scene = scene_of(bgr, kPointed_px);
    auto drawing = extract(image, request.extraction);
    if (drawing && !is_sure(*drawing)) drawing = tl::unexpected<std::string>("");
    if (drawing && drawing->mode == ExtractionMode::kStroke && !drawing->evidence.fainter &&
        keep_pointed_at(*drawing, request.pointing))
      return drawing;
    const auto mask = pointed_at(scene, request.pointing);
    if (!mask) return tl::unexpected(mask.error());
    // A drawing's own outline is finer.
    if (drawing && keep_pointed_at(*drawing, request.pointing) && is_like(*drawing, scene, *mask))
      return drawing;
    auto out = extraction_of(image, scene, *mask, bgr, request, "what is pointed at");
    if (out.contours.empty()) return tl::unexpected<std::string>("what is pointed at is too small to be cut");
    return out;
  }
  auto drawing = extract(image, request.extraction);
  if (!drawing || drawing->evidence.cut_off > 0) {
    if (auto padded = trimmed(image, request.extraction)) drawing = std::move(*padded);
  }
  if (mode == ExtractionMode::kStroke || mode == ExtractionMode::kThesis) return drawing;
  const bool sure = drawing && is_sure(*drawing);
  const bool both_sides = sure && drawing->evidence.opposite > 0.05;
  if (sure && !drawing->evidence.flattened && !both_sides) return drawing;
  const cv::Mat bgr = colour_plane(image);
  if (bgr.empty()) return drawing;
  const Scene scene = scene_of(bgr, kThings_px);
  const auto things = things_in(scene);
  if (both_sides) {  // dark and light on a ground between them
    if (!things || !holds(scene, things->mask, *drawing)) {
      drawing->why +=
          "; what lies off the background to the other side, lighter or darker, is left out (--at "
          "X,Y takes one of it)";
      return drawing;
    }
  } else if (sure && (!things || !are_solid(scene, things->mask))) {
    return drawing;
  }
  if (things) {
    auto out = extraction_of(image, scene, things->mask, bgr, request, why_of(*things));
    if (!out.contours.empty()) return out;
  }
  if (!drawing) return tl::unexpected(fmt::format("{}; or {}", drawing.error(), kRemedy));
  return tl::unexpected(fmt::format("the picture is no drawing on an even background, and {}; {}",
                                    things ? "nothing stands out from it" : things.error(), kRemedy));
}

}  // namespace

tl::expected<Extraction, std::string> contours_in(const cv::Mat& image, const PictureRequest& request) {
  auto out = found_in(image, request);
  if (!out) return out;
  if (const int dashes = dashes_in(out->contours); dashes > 0)
    out->why += fmt::format("; {} of {} contours are dashes, each of which is cut by itself", dashes,
                            out->contours.size());
  return out;
}

}  // namespace telekerf::vision
