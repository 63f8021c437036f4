// SPDX-License-Identifier: Apache-2.0
#include "common/vision/scaling.h"

namespace telekerf::vision {

Scale scale_for(const PixelContour& contour, int picture_width_px, int picture_height_px,
                const ScaleRequest& request) {
  Scale scale;
  if (request.metres_per_pixel) {
    scale.metres_per_pixel = *request.metres_per_pixel;
  } else if (request.picture_width_m) {
    scale.metres_per_pixel = *request.picture_width_m / picture_width_px;
    if (request.picture_height_m) {
      scale.pixel_aspect = *request.picture_height_m / picture_height_px / scale.metres_per_pixel;
    }
  } else {
    const double radius_px = geometry::bounding_circle(contour.points_px).radius_m;
    if (radius_px > 0.0) scale.metres_per_pixel = request.fill * request.workspace_radius_m / radius_px;
  }
  switch (request.anchor) {
    case AnchorMode::kBoundingBox:
      scale.anchor_px = geometry::bounding_box(contour.points_px).centre();
      break;
    case AnchorMode::kFirstPoint:
      if (!contour.points_px.empty()) scale.anchor_px = contour.points_px.front();
      break;
    case AnchorMode::kLowerLeft: {
      const geometry::Box box = geometry::bounding_box(contour.points_px);
      scale.anchor_px = Vec2(box.min.x(), box.max.y());
      break;
    }
    case AnchorMode::kImageCentre:
      scale.anchor_px = 0.5 * Vec2(picture_width_px - 1, picture_height_px - 1);
      break;
  }
  return scale;
}

geometry::Polyline to_workpiece(const PixelContour& contour, const Scale& scale) {
  geometry::Polyline out{{}, contour.closed};
  out.points_m.reserve(contour.points_px.size());
  for (const Vec2& p : contour.points_px) out.points_m.push_back(scale.to_workpiece(p));
  return out;
}

}  // namespace telekerf::vision
