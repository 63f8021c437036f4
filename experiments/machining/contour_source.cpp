// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/cutting_order.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"
#include "common/vision/load.h"
#include "experiments/machining/drawn_pictures.h"

namespace telekerf::experiments {
namespace {

/// What the lines enclose, holes taken out.
double area_m2(const std::vector<geometry::Polyline>& contours) {
  double sum = 0.0;
  for (const auto& inner : contours) {
    if (!inner.closed) continue;
    const auto around = std::count_if(contours.begin(), contours.end(), [&](const geometry::Polyline& outer) {
      return &outer != &inner && outer.closed && geometry::encloses(outer, inner);
    });
    sum += (around % 2 == 0 ? 1.0 : -1.0) * std::abs(geometry::signed_area_m2(inner));
  }
  return sum;
}

}  // namespace

ContourSource find_contour(const std::string& image, double width_mm, double workspace_radius_m,
                           bool closed) {
  vision::LoadRequest request;
  request.scale.workspace_radius_m = workspace_radius_m;
  if (width_mm > 0.0) request.scale.picture_width_m = width_mm * 1e-3;
  const cv::Mat drawing = drawn_picture(image);
  const bool drawn = !drawing.empty();
  const std::string file = drawn ? image : find_resource("pictures", image, ".png").string();
  const auto load = [&] {
    return drawn ? vision::contours_of(drawing, request) : vision::load_contours(file, request);
  };
  const auto found = load();
  if (!found) throw input_error(drawn ? fmt::format("{}: {}", file, found.error()) : found.error());
  if (!found->remarks.empty()) fmt::print(stderr, "{}: {}\n", file, found->remarks);
  const auto wanted = [&](const vision::LoadedContours& loaded) {
    return std::find_if(loaded.contours.begin(), loaded.contours.end(),
                        [&](const geometry::Polyline& c) { return c.closed == closed; });
  };
  if (const auto first = wanted(*found); first != found->contours.end()) return {*first, found->picture};
  if (found->mode != "vector") {
    request.extraction.mode = closed ? vision::ExtractionMode::kOutline : vision::ExtractionMode::kStroke;
    if (const auto again = load()) {
      // The middle of a region is no stroke: that is four times as long as it is wide, at least.
      const double least_m = closed ? 0.0 : 2.0 * std::sqrt(std::max(0.0, area_m2(found->contours)));
      const auto first = wanted(*again);
      if (first != again->contours.end() && geometry::length_m(*first) >= least_m)
        return {*first, again->picture};
    }
  }
  return {found->contours[found->selected], found->picture};
}

}  // namespace telekerf::experiments
