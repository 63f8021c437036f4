// SPDX-License-Identifier: Apache-2.0
// The grey levels of a plane: how often each occurs, and where they fall into two classes.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

namespace telekerf::vision {

/// How often each grey level occurs in a CV_8U plane; in a large one, among a quarter of its pixels.
using Histogram = std::array<double, 256>;
Histogram histogram_of(const cv::Mat& plane);

/// Otsu's split: the level that leaves the least variance within the two classes, and the classes' means.
struct Split {
  double level = 0.0;
  double low_mean = 0.0;
  double high_mean = 0.0;
  bool clear = false;  ///< two large classes, each of next to one grey level
};
Split otsu(const Histogram& counts);

/// Grey level below which `fraction` of the counts from `first` to `last` lie.
double percentile(const Histogram& counts, int first, int last, double fraction);

}  // namespace telekerf::vision
