// SPDX-License-Identifier: Apache-2.0
// Pixels -> workpiece metres (eq. 2-4 corrected: one scale for both axes, y upwards, an anchor that lands
// where it should).
#pragma once

#include <optional>

#include "common/runtime/enum_table.h"
#include "common/vision/extraction/pixel_contour.h"

namespace telekerf::vision {

/// Which point of the picture is put on the workpiece's origin.
enum class AnchorMode { kBoundingBox, kFirstPoint, kImageCentre, kLowerLeft };
inline constexpr EnumRow<AnchorMode> kAnchorModeRows[] = {
    {"box", AnchorMode::kBoundingBox, "the middle of the contour's bounding box"},
    {"first", AnchorMode::kFirstPoint, "the contour's first point"},
    {"image", AnchorMode::kImageCentre, "the middle of the picture or page"},
    {"lower-left", AnchorMode::kLowerLeft, "the lower left corner of all contours' bounding box"},
};
inline constexpr EnumTable<AnchorMode> kAnchorModes(kAnchorModeRows);

struct ScaleRequest {
  /// Width of the whole picture; wins over the fit.
  std::optional<double> picture_width_m = std::nullopt;
  /// Height of the whole picture, beside its width: pixels that are not square (eq. 2 has a scale for each
  /// axis).
  std::optional<double> picture_height_m = std::nullopt;
  /// Known from the camera's magnification; wins over everything.
  std::optional<double> metres_per_pixel = std::nullopt;
  /// Otherwise the contour's bounding circle becomes `fill` x this radius.
  double workspace_radius_m = 0.03;
  double fill = 0.6;
  AnchorMode anchor = AnchorMode::kBoundingBox;
};

/// x_m = k (x_px - a_x), y_m = -k c (y_px - a_y), c = 1 unless the picture's height is given too. The
/// picture's width in pixels counts whole pixels: from the left edge of the first to the right edge of the
/// last, so its middle is at (width - 1) / 2.
struct Scale {
  double metres_per_pixel = 1.0;  ///< across
  double pixel_aspect = 1.0;      ///< height of a pixel over its width
  Vec2 anchor_px = Vec2::Zero();

  Vec2 to_workpiece(const Vec2& px) const noexcept {
    return metres_per_pixel * Vec2(px.x() - anchor_px.x(), pixel_aspect * (anchor_px.y() - px.y()));
  }
  Vec2 to_picture(const Vec2& m) const noexcept {
    return anchor_px + Vec2(m.x(), -m.y() / pixel_aspect) / metres_per_pixel;
  }
};

/// The scale for one contour of an extraction.
Scale scale_for(const PixelContour& contour, int picture_width_px, int picture_height_px,
                const ScaleRequest& request);
geometry::Polyline to_workpiece(const PixelContour& contour, const Scale& scale);

}  // namespace telekerf::vision
