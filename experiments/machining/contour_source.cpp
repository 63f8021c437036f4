// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string_view>
#include <vector>

#include "common/geometry/cutting_order.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"
#include "common/vision/load.h"

namespace telekerf::experiments {
namespace {

/// An irregular outline like the ones of figure 8.5: a circle with eleven seeded harmonics, dark on a grey
/// ground with noise.
cv::Mat irregular_outline(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto spread = [&] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  std::array<double, 12> even{}, odd{};
  for (std::size_t k = 2; k < even.size(); ++k) {
    even[k] = 0.35 * spread() / std::pow(static_cast<double>(k), 1.3);
    odd[k] = 0.35 * spread() / std::pow(static_cast<double>(k), 1.3);
  }
  constexpr int kSide = 480;
  constexpr int kShift = 8;
  std::vector<cv::Point> points;
  for (int i = 0; i < 1440; ++i) {
    const double t = 2.0 * std::numbers::pi * i / 1440;
    double r = 1.0;
    for (std::size_t k = 2; k < even.size(); ++k) {
      r += even[k] * std::cos(static_cast<double>(k) * t) + odd[k] * std::sin(static_cast<double>(k) * t);
    }
    r = 130.0 * std::max(r, 0.3);
    points.emplace_back(static_cast<int>((0.5 * kSide + r * std::cos(t)) * (1 << kShift)),
                        static_cast<int>((0.5 * kSide + r * std::sin(t)) * (1 << kShift)));
  }
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(205));
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{points}, cv::Scalar(60), cv::LINE_AA, kShift);
  cv::GaussianBlur(image, image, {}, 0.8);
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      auto& v = image.at<std::uint8_t>(row, column);
      v = cv::saturate_cast<std::uint8_t>(v + 3.0 * spread());
    }
  }
  return image;
}

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
  constexpr std::string_view kDrawn = "outline-";
  const bool drawn = image.starts_with(kDrawn) && image.size() > kDrawn.size() && image.size() < 25 &&
                     image.find_first_not_of("0123456789", kDrawn.size()) == image.npos;
  const std::string file = drawn ? image : find_resource("pictures", image, ".png").string();
  const auto load = [&] {
    return drawn ? vision::contours_of(irregular_outline(std::stoull(image.substr(kDrawn.size()))), request)
                 : vision::load_contours(file, request);
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
