// SPDX-License-Identifier: Apache-2.0
// Picture -> ordered points: one interface for the three ways to get there (thesis 3.1).
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

enum class Mode {
  kAuto,     ///< outline for filled regions, stroke for thin drawn lines
  kThesis,   ///< Gaussian, Canny, dilate/erode, a window that travels along the edge band (3.1.1-3.1.3)
  kOutline,  ///< the closed boundary of a region, sub-pixel
  kStroke,   ///< one pass along the centre line of a drawn stroke
};

std::string_view name_of(Mode mode);
std::optional<Mode> mode_of(std::string_view name);

struct ExtractSettings {
  Mode mode = Mode::kAuto;
  /// Where an open contour starts and ends, or a closed one starts; pixels, top left pixel's centre = (0, 0).
  std::optional<Vec2> start_px = std::nullopt;
  std::optional<Vec2> end_px = std::nullopt;
  /// Contours smaller than this share of the largest one are specks, not contours.
  double smallest_share = 0.05;
};

/// One contour in pixels: x to the right, y downwards, pixel centres at whole numbers. Closed outlines run
/// anticlockwise as seen in the picture; holes run clockwise.
struct PixelContour {
  std::vector<Vec2> points_px;
  bool closed = true;
  bool hole = false;      ///< the inner boundary of a region
  double width_px = 0.0;  ///< of the stroke; 0 for outlines
  double noise_px = 0.0;  ///< rms of what the last smoothing took away: the quality of the points
};

struct Extraction {
  Mode mode = Mode::kOutline;  ///< the one that was used
  std::string why;             ///< one clause: why this mode
  int picture_width_px = 0;
  int picture_height_px = 0;
  double contrast = 0.0;               ///< of drawing and background, grey levels
  double noise = 0.0;                  ///< of the picture, standard deviation in grey levels
  std::vector<PixelContour> contours;  ///< largest first, never empty
};

/// The contours of a picture of any depth, with 1, 3 or 4 channels. The error is one sentence that says what
/// is wrong with the picture; success always holds at least one contour of at least four points.
tl::expected<Extraction, std::string> extract(const cv::Mat& image, const ExtractSettings& settings = {});

/// Reads a still picture of any format OpenCV knows, at most 128 Mpx; larger than 24 Mpx comes back reduced,
/// with the factor in `reduction`.
struct Picture {
  cv::Mat image;
  double reduction = 1.0;  ///< original pixels per pixel of `image`
};
tl::expected<Picture, std::string> read_picture(const std::string& file);

}  // namespace telekerf::vision
