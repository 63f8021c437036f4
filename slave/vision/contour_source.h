// SPDX-License-Identifier: Apache-2.0
// One picture or drawing -> its contours in workpiece metres, ready to be published.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "common/protocol/messages.h"
#include "common/vision/picture_flags.h"

namespace telekerf::vision_process {

struct ContourRequest {
  std::string image;  ///< a shipped picture's name, or a path to a picture, SVG or DXF
  vision::ExtractionMode mode = vision::ExtractionMode::kAuto;
  vision::PictureFlags picture;                                  ///< what of the picture is meant
  vision::AnchorMode anchor = vision::AnchorMode::kBoundingBox;  ///< what lies on the workpiece's origin
  std::optional<Vec2> start_px;   ///< where the contour begins, a pixel of the file
  std::optional<Vec2> end_px;     ///< and where it ends
  std::size_t select = 0;         ///< which contour; 0 is the largest
  std::optional<double> width_m;  ///< of the whole picture; otherwise the contour is fitted to the workspace
  double workspace_radius_m = 0.02;  ///< of the slave
  /// Beta times the workspace of the robot that the operator's hand moves, if there is one: what is fitted
  /// fits it too.
  std::optional<double> hand_radius_m;
  bool fit_all = false;           ///< all contours together are centred and fitted, not the longest alone
  vision::VectorRequest drawing;  ///< of an SVG or DXF file
};

/// What the vision library is asked for.
vision::LoadRequest load_request(const ContourRequest& request);
/// The selected contour as it is published with the others beside it, its id a digest of all their points.
/// The error is one sentence: it does not fit into the workspace.
tl::expected<ContourMessage, std::string> message_of(const vision::LoadedContours& loaded,
                                                     const std::string& source, double workspace_radius_m);

/// Reads, extracts, scales. Throws StartupError: no such file, no picture, no contour, or larger than the
/// workspace.
ContourMessage find_contour(const ContourRequest& request);

}  // namespace telekerf::vision_process
