// SPDX-License-Identifier: Apache-2.0
// The lines of a thinned drawing as a graph.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// Distance from a pixel to the nearest one that is not drawn, in pixels.
double half_width_at(const cv::Mat& drawn, const cv::Point& p);

/// Lines between ends and junctions. Pixels of a line exclude those of its nodes.
struct SkeletonGraph {
  struct Line {
    std::vector<cv::Point> pixels;
    int from = -1;  ///< node; -1 on both sides: a ring without a node
    int to = -1;
  };
  struct Node {
    std::vector<cv::Point> pixels;
    int degree = 0;  ///< ends of lines that meet here
    Vec2 position() const;
  };
  std::vector<Line> lines;
  std::vector<Node> nodes;
};
SkeletonGraph graph_of(const cv::Mat& skeleton);

/// The graph without branches that are no longer than what the stroke's own width grows (1.5 x half width + 2
/// pixels); erases them from the skeleton, a few times over.
SkeletonGraph pruned(SkeletonGraph graph, cv::Mat& skeleton, const cv::Mat& drawn);

}  // namespace telekerf::vision
