// SPDX-License-Identifier: Apache-2.0
// What stands for the thesis' pictures is found as what it is meant to be: one closed outline.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "experiments/machining/contour_source.h"
#include "experiments/machining/drawn_pictures.h"

namespace telekerf::experiments {
namespace {

constexpr double kWorkspace_m = 0.03;

/// Distances of the contour's points from the middle, at equal angles.
std::vector<double> radii(const geometry::Polyline& line) {
  const Vec2 middle = geometry::bounding_box(line.points_m).centre();
  std::vector<double> out(720, 0.0);
  for (const Vec2& p : geometry::resampled(line, geometry::length_m(line) / 7200).points_m) {
    const Vec2 d = p - middle;
    const double turn = std::atan2(d.y(), d.x()) / (2 * M_PI) + 0.5;
    out[std::min<std::size_t>(719, static_cast<std::size_t>(720 * turn))] = d.norm();
  }
  return out;
}

TEST(DrawnPictures, EachShowsOneClosedOutlineThatFillsAGoodPartOfIt) {
  for (const char* name : {"eight-leg-cam", "melanoma-like", "tissue-like", "hand-drawn", "outline-1"}) {
    const ContourSource found = find_contour(name, 48.0, kWorkspace_m, true);  // 0.1 mm a pixel
    EXPECT_TRUE(found.contour.closed) << name;
    const auto around = radii(found.contour);
    const double mean = std::accumulate(around.begin(), around.end(), 0.0) / 720;
    EXPECT_NEAR(mean, 14e-3, 2e-3) << name << ": drawn with 130 to 150 pixels";
  }
}

TEST(DrawnPictures, TheCamHasEightLegs) {
  const auto around = radii(find_contour("eight-leg-cam", 48.0, kWorkspace_m, true).contour);
  const double middle = 15e-3;
  int legs = 0;
  for (std::size_t i = 0; i < around.size(); ++i)
    legs += around[i] > middle && around[(i + 1) % around.size()] <= middle ? 1 : 0;
  EXPECT_EQ(legs, 8);
}

TEST(DrawnPictures, TheSameNameIsTheSamePictureAndOthersAreNone) {
  for (const char* name : {"eight-leg-cam", "melanoma-like", "tissue-like", "hand-drawn", "outline-7"})
    EXPECT_EQ(cv::norm(drawn_picture(name), drawn_picture(name), cv::NORM_INF), 0.0) << name;
  for (const char* name : {"", "outline-", "outline-x", "heart", "outline-99999999999999999999"})
    EXPECT_TRUE(drawn_picture(name).empty()) << name;
}

}  // namespace
}  // namespace telekerf::experiments
