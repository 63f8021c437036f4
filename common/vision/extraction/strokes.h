// SPDX-License-Identifier: Apache-2.0
// One pass along the centre line of each drawn stroke: thinning, a graph, straight on at crossings, sub-pixel
// centring.
#pragma once

#include <vector>

#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/extraction/skeleton.h"

namespace telekerf::vision {

/// A way through the graph: pixels in order, and where it passed a junction.
struct Route {
  std::vector<Vec2> points_px;
  std::vector<bool>
      junction;  ///< the point lies where strokes overlap: its position says nothing about one of them
  bool closed = false;
  bool from_end = false;  ///< starts at the free end of a stroke (not at another stroke's side)
  bool to_end = false;
};

/// Every line of the graph once, joined at junctions so that the path turns as little as possible. Junctions
/// that a flat crossing has pulled apart are joined first: up to five stroke widths, as long as the ink
/// between is wider than one stroke. `width_px` is the stroke's.
std::vector<Route> routes_through(const SkeletonGraph& graph, const cv::Mat& drawn, double width_px);

/// Replaces the marked points by a cubic that continues the directions on both sides.
void bridge(std::vector<Vec2>& points, const std::vector<bool>& junction, bool closed);

/// Moves each point to the middle between the stroke's two borders, bridges what lies within junctions by a
/// cubic, and sets free ends half a width inside the ink (the centre of a round pen). Returns the contour
/// unsmoothed.
PixelContour centred(const Field& field, const Route& route, double width_px);

/// Moves each point of a way along an edge onto the border between drawing and background.
PixelContour on_border(const Field& field, const Route& route);

}  // namespace telekerf::vision
