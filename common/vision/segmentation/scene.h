// SPDX-License-Identifier: Apache-2.0
// A photograph in small, in colours as people tell them apart, and how far each pixel lies off the
// background.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// A picture whose longer side has at most the pixels that were asked for.
struct Scene {
  cv::Mat bgr;             ///< CV_8UC3
  cv::Mat lab;             ///< CV_32FC3, CIE L*a*b*, lightly smoothed: a distance of 2 is just seen
  double reduction = 1.0;  ///< pixels of the picture per pixel of the scene

  /// From the picture's pixels to the scene's and back.
  Vec2 to_scene(const Vec2& px) const noexcept {
    return (px + Vec2::Constant(0.5)) / reduction - Vec2::Constant(0.5);
  }
  Vec2 to_picture(const Vec2& px) const noexcept {
    return (px + Vec2::Constant(0.5)) * reduction - Vec2::Constant(0.5);
  }
};

/// `bgr`: CV_8UC3. `longest_px`: of the scene's longer side, at most.
Scene scene_of(const cv::Mat& bgr, int longest_px);

/// Distance of each pixel's colour from that of the background.
struct Backdrop {
  cv::Mat distance;        ///< CV_32F, units of L*a*b*
  double spread = 0.0;     ///< median of it along the picture's border
  double uniform = 0.0;    ///< fraction of the border that the background explains
  double tolerance = 0.0;  ///< distance up to which a pixel is background
};

/// The background's colour is a parabola in x and y through the picture's border, and through all within that
/// looks like it: fitted again and again without what lies off it.
Backdrop backdrop_of(const Scene& scene);

}  // namespace telekerf::vision
