// SPDX-License-Identifier: Apache-2.0
// The contour that an experiment machines, and the picture that it comes from.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/geometry/polyline.h"

namespace telekerf::experiments {

struct ContourSource {
  geometry::Polyline contour;
  cv::Mat picture;  ///< empty for vector drawings
};

/// The largest contour of the expected kind; if the picture shows none at first sight, it is looked at as
/// strokes or as outlines. Failing that the largest contour is taken as it is. `image`: a shipped name, a
/// file, or one that is drawn here (drawn_pictures.h). `width_mm` of the
/// whole picture, 0: fitted to the workspace. Throws StartupError.
ContourSource find_contour(const std::string& image, double width_mm, double workspace_radius_m, bool closed);

}  // namespace telekerf::experiments
