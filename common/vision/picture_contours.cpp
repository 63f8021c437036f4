// SPDX-License-Identifier: Apache-2.0
#include "common/vision/picture_contours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/vision/extraction/ends.h"
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
  // Edges of what was cleared away are still explained by nothing.
  if (e.cleared && e.unevenness < 0.15 && e.ink_range < 0.5) return e.explained > 0.5;
  if (!e.one_pen || (e.cut_off >= 3 && e.cut_off_share > 0.35)) return false;
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

}  // namespace

tl::expected<Extraction, std::string> contours_in(const cv::Mat& image, const PictureRequest& request) {
  const ExtractionMode mode = request.extraction.mode;
  if (request.pointing.any()) {
    if (mode == ExtractionMode::kStroke || mode == ExtractionMode::kThesis)
      return tl::unexpected(fmt::format("--at and --box find the outline of a thing; leave out --mode {}",
                                        kExtractionModes.word(mode)));
    const cv::Mat bgr = colour_plane(image);
    if (bgr.empty()) return tl::unexpected<std::string>("the picture is empty");
    if (const auto misfit = beyond(request.pointing, bgr)) return tl::unexpected(*misfit);
    const Scene scene = scene_of(bgr, kPointed_px);
    const auto mask = pointed_at(scene, request.pointing);
    if (!mask) return tl::unexpected(mask.error());
    auto out = extraction_of(image, scene, *mask, bgr, request, "what is pointed at");
    if (out.contours.empty()) return tl::unexpected<std::string>("what is pointed at is too small to be cut");
    return out;
  }
  auto drawing = extract(image, request.extraction);
  if (mode == ExtractionMode::kStroke || mode == ExtractionMode::kThesis) return drawing;
  if (drawing && is_sure(*drawing)) return drawing;
  const cv::Mat bgr = colour_plane(image);
  if (bgr.empty()) return drawing;
  const Scene scene = scene_of(bgr, kThings_px);
  const auto mask = things_in(scene);
  if (mask) {
    auto out =
        extraction_of(image, scene, *mask, bgr, request, "a thing that stands out from its background");
    if (!out.contours.empty()) return out;
  }
  if (!drawing) return tl::unexpected(fmt::format("{}; or {}", drawing.error(), kRemedy));
  return tl::unexpected(fmt::format("the picture is no drawing on an even background, and {}; {}",
                                    mask ? "nothing stands out from it" : mask.error(), kRemedy));
}

}  // namespace telekerf::vision
