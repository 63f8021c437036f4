// SPDX-License-Identifier: Apache-2.0
// Ways through the graph of a thinned drawing, straight on at crossings.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/extraction/skeleton.h"

namespace telekerf::vision {

/// A way through the graph: pixels in order, and where it passed a junction.
struct Route {
  std::vector<Vec2> points_px;
  /// The point lies where strokes overlap: its position says nothing about one of them.
  std::vector<bool> junction;
  bool closed = false;
  bool from_end = false;  ///< starts at the free end of a stroke (not at another stroke's side)
  bool to_end = false;
};

/// Every line of the graph once, joined at junctions so that the path turns as little as possible. Junctions
/// that a flat crossing has pulled apart are joined first: up to five stroke widths, as long as the ink
/// between is wider than one stroke. `width_px` is the stroke's.
std::vector<Route> routes_through(const SkeletonGraph& graph, const cv::Mat& drawn, double width_px);

}  // namespace telekerf::vision
