// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/judging.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/vision/segmentation/rating.h"
#include "common/vision/segmentation/sides.h"

namespace telekerf::vision {
namespace {

/// Length of an outline over that of the band stretched round it, 1 or more: thin and long is not crooked.
double crookedness(const std::vector<cv::Point>& outline) {
  std::vector<cv::Point> hull;
  cv::convexHull(outline, hull);
  return cv::arcLength(outline, true) / std::max(1.0, cv::arcLength(hull, true));
}

}  // namespace

const char* why_no_thing(const Scene& scene, const cv::Mat& mask) {
  constexpr double kBackground = 0.46;  // of the outline lies along the border
  constexpr double kAround = 0.25;      // likewise, where it touches three sides or more
  constexpr double kRagged = 0.1;       // see Rating::round
  constexpr double kWinding = 0.15;     // likewise, where the outline is crooked as well
  constexpr double kCrooked = 1.5;
  constexpr double kBlind = 0.15;  // and Rating::blind: of things that are right at most a third of this
  constexpr double kMost = 0.45;   // of the picture: what is left of it without the things
  constexpr double kMostRagged = 0.3;
  constexpr double kMostAlike = 0.12;  // see likeness_to_ring()
  constexpr double kSame = 0.92;       // likewise: things that are right have at most 0.85
  // The more of an outline separates nothing (from one ninth of it on), the clearer must the rest be.
  constexpr double kUnseparated = 0.11;
  constexpr double kClear = 22.0;  // Rating::weak, units of L*a*b*
  constexpr double kClearer = 60.0;
  // What ends at the picture's border has less of an outline of its own: that must be clearer than the texture beside it.
  constexpr double kEndsThere = 0.05;  // of the outline
  constexpr double kOverTexture = 2.0;
  constexpr double kRest = 0.6;  // a large part of the picture that is as like the rest of it as this...
  constexpr double kJoined = 0.07;  // ...and of whose outline as much separates nothing
  const double alike = likeness_to_ring(scene, mask);
  if (alike > kSame) return "round what is pointed at lies more of the same: it looks like a pattern";
  for (const auto& outline : outlines_of_mask(mask, 12.0)) {
    const Rating rating = rating_of(scene, outline);
    if (rating.touching > (rating.sides >= 3 ? kAround : kBackground))
      return "what is pointed at runs along the picture's border: it looks like the background";
    if (rating.area > kMost && rating.round < kMostRagged && alike > kMostAlike)
      return "what is pointed at fills most of the picture and has no even outline: it looks like the "
             "background";
    if (rating.touching > kEndsThere && rating.weak < kOverTexture * rating.texture)
      return "what is pointed at runs on to the picture's border, and elsewhere its outline is no clearer than the "
             "texture beside it";
    const double merged = unseparated(scene, mask, outline);
    if (rating.area > kMost && alike > kRest && merged > kJoined)
      return "what is pointed at fills most of the picture and is like the rest of it: it looks like the background";
    if (rating.round < kRagged || (rating.round < kWinding && crookedness(outline) > kCrooked) ||
        rating.blind > kBlind || (merged > kUnseparated && rating.weak < kClear + kClearer * merged))
      return "what is pointed at has no outline that can be told from its surroundings";
  }
  return nullptr;
}

}  // namespace telekerf::vision
