// SPDX-License-Identifier: Apache-2.0
// Picture -> ordered points: one interface for the three ways to get there (thesis 3.1).
#pragma once

#include <algorithm>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "common/runtime/bounds.h"
#include "common/runtime/enum_table.h"
#include "common/vision/extraction/pixel_contour.h"

namespace telekerf::vision {

/// Share of the way from background to drawing at which a border may lie.
inline constexpr Bounds kLevels{.min = 0.02, .max = 0.98};
inline constexpr double kHalfWay = 0.5;

enum class ExtractionMode {
  kAuto,     ///< outline for filled regions, stroke for thin drawn lines
  kThesis,   ///< Gaussian, Canny, dilate/erode, a window that travels along the edge band (3.1.1-3.1.3)
  kOutline,  ///< the closed boundary of a region, sub-pixel
  kStroke,   ///< one pass along the centre line of a drawn stroke
};

inline constexpr EnumRow<ExtractionMode> kExtractionModeRows[] = {
    {"auto", ExtractionMode::kAuto, "outline for filled regions, stroke for thin drawn lines"},
    {"outline", ExtractionMode::kOutline, "the closed boundary of a region, finer than a pixel"},
    {"stroke", ExtractionMode::kStroke, "one pass along the centre line of a drawn stroke"},
    {"thesis", ExtractionMode::kThesis, "Canny's edges, and a window that travels along their band"},
};
inline constexpr EnumTable<ExtractionMode> kExtractionModes(kExtractionModeRows);

struct ExtractionSettings {
  ExtractionMode mode = ExtractionMode::kAuto;
  /// Where an open contour starts and ends, or a closed one starts; pixels, top left pixel's centre = (0, 0).
  std::optional<Vec2> start_px = std::nullopt;
  std::optional<Vec2> end_px = std::nullopt;
  /// Contours smaller than this fraction of the largest one are specks, not contours.
  double min_size_fraction = 0.05;
  /// Smaller ones, by the diagonal of their box; in place of the fraction.
  std::optional<double> min_size_px = std::nullopt;
  /// Where borders lie, within kLevels; of mode thesis how clear an edge must be. None: half way there, or
  /// wherever the picture is explained best, each border moved to the light around it.
  std::optional<double> level = std::nullopt;
};

/// What speaks for a picture being a drawing, one ink on one paper.
struct DrawingEvidence {
  double explained = 0.0;  ///< fraction of its sharp edges that lie on the border of what is drawn
  double explained_with_fainter = 0.0;  ///< likewise of the two levels of a drawing in two tones
  double unevenness = 0.0;         ///< range of four fifths of the paper's grey levels, over the contrast
  double unevenness_beside = 0.0;  ///< of the paper beside what is fainter, too
  double ink_range = 0.0;          ///< likewise of what is drawn
  double opposite = 0.0;           ///< clear edges on the other side of the background, beside one of its own
  bool fainter = false;            ///< parts of it stand out by less than half of the contrast
  bool flattened = false;          ///< lines across shadows, or what was taken for them
  bool cleared = false;            ///< hair has been taken away
  bool one_pen = true;             ///< strokes among shapes that are cut off are of even width
  int cut_off = 0;                 ///< shapes that run over the picture's border
  double cut_off_share = 0.0;      ///< of what is drawn
};

/// Contours that are too small to count.
struct SmallParts {
  int small = 0;
  double largest_px = 0.0;  ///< diagonal of the box of the largest

  void add(const SmallParts& others) {
    small += others.small;
    largest_px = std::max(largest_px, others.largest_px);
  }
};

struct Extraction {
  ExtractionMode mode = ExtractionMode::kOutline;  ///< the one that was used
  std::string why;                                 ///< one clause: why this mode
  int picture_width_px = 0;
  int picture_height_px = 0;
  double contrast = 0.0;  ///< of drawing and background, grey levels
  double noise = 0.0;     ///< of the picture, standard deviation in grey levels
  DrawingEvidence evidence;
  SmallParts left_out;
  Contours contours;  ///< largest first, never empty
};

/// The contours of a picture of any depth, with 1, 3 or 4 channels. The error is one sentence that says what
/// is wrong with the picture; success always holds at least one contour of at least four points.
tl::expected<Extraction, std::string> extract(const cv::Mat& image, const ExtractionSettings& settings = {});

}  // namespace telekerf::vision
