// SPDX-License-Identifier: Apache-2.0
// One picture or drawing -> one contour in workpiece metres, ready to be published.
#pragma once

#include <optional>
#include <string>

#include "common/bus/messages.h"

namespace telekerf::vision {

struct ContourRequest {
  std::string image;              ///< a shipped picture's name, or a path to a picture, SVG or DXF
  std::string mode = "auto";      ///< auto, outline, stroke, thesis
  std::optional<double> width_m;  ///< of the whole picture; otherwise the contour is fitted to the workspace
  double workspace_radius_m = 0.02;  ///< of the slave
};

/// Reads, extracts, scales: the contour that is longest. Throws Refusal: no such file, no picture, no
/// contour, or larger than the workspace.
ContourMessage find_contour(const ContourRequest& request);

}  // namespace telekerf::vision
