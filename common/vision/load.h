// SPDX-License-Identifier: Apache-2.0
// Any input -> contours in workpiece metres: the one way from a file to a path.
#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/vision/paper.h"
#include "common/vision/picture_contours.h"
#include "common/vision/scaling.h"
#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

struct LoadRequest {
  ExtractionSettings extraction;
  Pointing pointing;
  Paper paper = Paper::kNone;  ///< of a picture: the sheet that it shows says its size and perspective
  std::optional<double> smallest_m = std::nullopt;  ///< size of the smallest contour of a picture that counts
  ScaleRequest scale;
  std::size_t select = 0;  ///< which contour is anchored and fitted; 0 is the largest
  bool fit_all = false;    ///< all contours together are anchored and fitted
  VectorRequest drawing;   ///< of a vector drawing
};

/// What is said of one contour; those that are left out have a reason.
struct ContourLabel {
  std::string layer;  ///< of a vector drawing
  std::string colour;
  std::string left_out_why;  ///< empty: it is to be cut
};

/// All contours share one frame: that of the selected one's anchor.
struct LoadedContours {
  std::string mode;                          ///< outline, stroke, thesis, or vector
  std::string why;                           ///< of the mode, and then the remarks
  std::string remarks;                       ///< what people should know of what was found; often empty
  std::string unsupported;                   ///< what of a vector drawing is left out, "2 text, 1 image"
  std::vector<geometry::Polyline> contours;  ///< metres, largest first
  std::vector<double> noise_m;               ///< quality of each contour's points
  std::vector<ContourLabel> labels;          ///< one a contour; none: nothing is said
  std::vector<geometry::Polyline> left_out;  ///< found and not to be cut, in the same frame
  std::vector<ContourLabel> left_out_labels;
  std::string size_from;  ///< what says how large it is
  std::size_t selected = 0;
  double metres_per_pixel = 0.0;  ///< 0 for vector drawings
  double contrast = 0.0;          ///< grey levels; 0 for vector drawings
  double picture_noise = 0.0;     ///< standard deviation, grey levels
  int picture_width_px = 0;
  int picture_height_px = 0;
  Scale scale;             ///< pictures only: from the pixels of `picture`
  double reduction = 1.0;  ///< pixels of the file for one of `picture`, which is read reduced if it is large
  cv::Mat picture;         ///< as it was read; empty for vector drawings
};

/// A vector file keeps its own true size (a request for a picture's width stretches its page to that width);
/// a picture is extracted and scaled as asked. The error is one sentence.
tl::expected<LoadedContours, std::string> load_contours(const std::string& path, const LoadRequest& request);
/// The same for a picture in hand, e.g. from a camera.
tl::expected<LoadedContours, std::string> contours_of(const cv::Mat& image, const LoadRequest& request);

}  // namespace telekerf::vision
