// SPDX-License-Identifier: Apache-2.0
// Photographs of things: found without a word, or pointed at. Likenesses drawn here, whose outlines are
// known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/load.h"
#include "common/vision/segmentation/snapping.h"
#include "common/vision/segmentation/things.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

/// Grain of a camera, the same each time.
void add_grain(cv::Mat& picture, double sigma, std::uint64_t seed = 1) {
  cv::RNG rng(seed);
  cv::Mat grain(picture.size(), CV_16SC(picture.channels()));
  rng.fill(grain, cv::RNG::NORMAL, 0.0, sigma);
  cv::Mat wide;
  picture.convertTo(wide, grain.type());
  wide += grain;
  wide.convertTo(picture, picture.type());
}

/// Light that falls off to one side.
void add_falling_light(cv::Mat& picture, double share) {
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double gain = 1.0 - share * x / picture.cols;
      auto& p = picture.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) p[c] = cv::saturate_cast<unsigned char>(gain * p[c]);
    }
  }
}

/// Patches of all sizes in colours between two.
cv::Mat texture(const cv::Size& size, const cv::Scalar& a, const cv::Scalar& b, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat plane(size, CV_32F);
  rng.fill(plane, cv::RNG::UNIFORM, 0.0, 1.0);
  cv::GaussianBlur(plane, plane, {}, 5.0);
  cv::normalize(plane, plane, 0.0, 1.0, cv::NORM_MINMAX);
  cv::Mat out(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double u = plane.at<float>(y, x);
      for (int c = 0; c < 3; ++c)
        out.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(a[c] + u * (b[c] - a[c]));
    }
  }
  return out;
}

geometry::Polyline circle(const Vec2& centre, double radius) {
  geometry::Polyline out{{}, true};
  for (int i = 0; i < 360; ++i)
    out.points_m.push_back(centre + radius * Vec2(std::cos(i * M_PI / 180), std::sin(i * M_PI / 180)));
  return out;
}

void disc(cv::Mat& picture, const Vec2& centre, double radius, const cv::Scalar& colour) {
  constexpr int kShift = 4;
  cv::circle(picture, {static_cast<int>(centre.x() * 16), static_cast<int>(centre.y() * 16)},
             static_cast<int>(radius * 16), colour, cv::FILLED, cv::LINE_AA, kShift);
}

/// A speckled disc whose inside changes as much as a coin's does.
void coin(cv::Mat& picture, const Vec2& centre, double radius, std::uint64_t seed) {
  cv::Mat face = texture(picture.size(), {150, 150, 150}, {220, 220, 220}, seed);
  cv::Mat mask(picture.size(), CV_8U, cv::Scalar(0));
  disc(mask, centre, radius, cv::Scalar(255));
  face.copyTo(picture, mask > 127);
}

TEST(Things, ABrightCellOnGreyIsFoundWithoutAWord) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(100, 100, 100));
  disc(picture, {400, 260}, 60, cv::Scalar(80, 80, 80));  // its halo
  cv::GaussianBlur(picture, picture, {}, 12.0);
  disc(picture, {400, 260}, 45, cv::Scalar(205, 205, 205));
  cv::GaussianBlur(picture, picture, {}, 1.5);
  add_falling_light(picture, 0.25);
  add_grain(picture, 6.0);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 1u);
  const Comparison c = compare(found->contours.front(), circle({400, 260}, 45));
  EXPECT_LT(c.rms_px, 0.7);
  EXPECT_LT(c.max_px, 2.5);
  EXPECT_NEAR(c.length_ratio, 1.0, 0.02);
}

TEST(Things, RowsOfCoinsOnADarkClothAreSeveralContours) {
  cv::Mat picture = texture({640, 480}, {40, 42, 45}, {70, 70, 72}, 3);
  std::vector<Vec2> centres;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      centres.emplace_back(100 + 145 * column, 90 + 150 * row);
      coin(picture, centres.back(), 34 + 3 * ((row + column) % 4), 10 + centres.size());
    }
  }
  cv::GaussianBlur(picture, picture, {}, 0.8);
  add_falling_light(picture, 0.35);
  add_grain(picture, 4.0);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), centres.size());
  for (const PixelContour& contour : found->contours) {
    const Vec2 middle = geometry::bounding_box(contour.points_px).centre();
    EXPECT_TRUE(std::any_of(centres.begin(), centres.end(), [&](const Vec2& c) {
      return (c - middle).norm() < 1.5;
    })) << middle.transpose();
  }
}

TEST(Things, ColourAloneTellsAFruitFromItsTable) {
  // As bright as the table, and shaded from one side.
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(60, 130, 140));
  disc(picture, {300, 240}, 120, cv::Scalar(50, 95, 235));
  disc(picture, {330, 200}, 25, cv::Scalar(90, 140, 255));  // where the light glances off
  cv::GaussianBlur(picture, picture, {}, 1.2);
  add_falling_light(picture, 0.3);
  add_grain(picture, 5.0);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 1u);
  EXPECT_LT(compare(found->contours.front(), circle({300, 240}, 120)).rms_px, 0.7);
}

TEST(Things, AHoleThatTheBackgroundIsSeenThroughIsKept) {
  cv::Mat picture = texture({640, 480}, {60, 70, 80}, {80, 95, 105}, 8);
  const cv::Mat cloth = picture.clone();
  coin(picture, {320, 240}, 140, 21);
  cv::Mat hole(picture.size(), CV_8U, cv::Scalar(0));
  disc(hole, {320, 240}, 60, cv::Scalar(255));
  cloth.copyTo(picture, hole > 127);
  cv::GaussianBlur(picture, picture, {}, 0.9);
  add_falling_light(picture, 0.2);
  add_grain(picture, 4.0);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 2u);
  EXPECT_FALSE(found->contours[0].hole);
  EXPECT_TRUE(found->contours[1].hole);
  EXPECT_LT(compare(found->contours[0], circle({320, 240}, 140)).rms_px, 0.7);
  EXPECT_LT(compare(found->contours[1], circle({320, 240}, 60)).rms_px, 0.7);
}

TEST(Things, WhatLiesOnTextureIsFoundWhenPointedAt) {
  cv::Mat picture = texture({640, 480}, {30, 90, 40}, {90, 200, 120}, 5);
  const cv::Mat inside = texture({640, 480}, {30, 40, 140}, {120, 110, 240}, 6);
  cv::Mat mask(480, 640, CV_8U, cv::Scalar(0));
  disc(mask, {250, 220}, 110, cv::Scalar(255));
  inside.copyTo(picture, mask > 127);
  cv::GaussianBlur(picture, picture, {}, 1.0);
  add_grain(picture, 4.0);
  PictureRequest request;
  request.pointing.at = {{250, 230}};
  PictureRequest in_box;
  in_box.pointing.box = Eigen::Vector4d(110, 80, 290, 290);
  for (const PictureRequest& asked : {request, in_box}) {
    const auto found = contours_in(picture, asked);
    ASSERT_TRUE(found) << found.error();
    ASSERT_EQ(found->contours.size(), 1u);
    const Comparison c = compare(found->contours.front(), circle({250, 220}, 110));
    EXPECT_LT(c.rms_px, 1.5);
    EXPECT_NEAR(c.length_ratio, 1.0, 0.04);
  }
}

TEST(Things, WhatRunsOverTheBorderIsFoundWhenPointedAtAndFollowsIt) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(200, 205, 210));
  disc(picture, {320, 480}, 150, cv::Scalar(40, 60, 120));
  cv::GaussianBlur(picture, picture, {}, 1.0);
  add_grain(picture, 4.0);
  EXPECT_FALSE(contours_in(picture, {}));
  PictureRequest request;
  request.pointing.at = {{320, 430}};
  const auto found = contours_in(picture, request);
  ASSERT_TRUE(found) << found.error();
  const geometry::Box box = geometry::bounding_box(found->contours.front().points_px);
  EXPECT_NEAR(box.min.y(), 330.0, 2.0);
  EXPECT_NEAR(box.max.y(), 479.0, 1.5);
  EXPECT_NEAR(box.size().x(), 300.0, 4.0);
}

TEST(Things, AnEvenSkyHasNoOutlineOfItsOwn) {
  // Darker upwards, a tower in it: any region of the sky would end where nothing is seen.
  cv::Mat picture(480, 640, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<unsigned char>(90 + y / 5), 70, 40);
  }
  cv::rectangle(picture, {150, 150}, {190, 479}, cv::Scalar(150, 170, 180), cv::FILLED);
  cv::rectangle(picture, {0, 430}, {639, 479}, cv::Scalar(20, 30, 20), cv::FILLED);
  cv::GaussianBlur(picture, picture, {}, 1.0);
  add_grain(picture, 3.0);
  for (const Vec2& p : {Vec2(450, 330), Vec2(400, 100), Vec2(60, 60)}) {
    PictureRequest request;
    request.pointing.at = {p};
    const auto found = contours_in(picture, request);
    ASSERT_FALSE(found) << p.transpose() << ": " << found->why << ", " << length_px(found->contours.front());
    EXPECT_NE(found.error().find("--box"), std::string::npos) << found.error();
  }
}

TEST(Things, SeveralPointsAreSeveralThingsAndNotLeavesOut) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(190, 190, 190));
  disc(picture, {150, 150}, 60, cv::Scalar(40, 40, 200));
  disc(picture, {450, 300}, 80, cv::Scalar(200, 60, 40));
  disc(picture, {150, 380}, 50, cv::Scalar(60, 160, 60));
  add_grain(picture, 4.0);
  PictureRequest request;
  request.pointing.at = {{150, 150}, {450, 300}};
  const auto found = contours_in(picture, request);
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 2u);
  EXPECT_LT(compare(found->contours[0], circle({450, 300}, 80)).rms_px, 0.7);
  EXPECT_LT(compare(found->contours[1], circle({150, 150}, 60)).rms_px, 0.7);

  // Two halves of other colours: with a point in one and --not in the other only the one.
  cv::Mat halves(480, 640, CV_8UC3, cv::Scalar(190, 190, 190));
  cv::rectangle(halves, {160, 140}, {319, 339}, cv::Scalar(30, 30, 170), cv::FILLED);
  cv::rectangle(halves, {320, 140}, {480, 339}, cv::Scalar(30, 120, 170), cv::FILLED);
  add_grain(halves, 4.0);
  PictureRequest one;
  one.pointing.at = {{240, 240}};
  one.pointing.away = {{400, 240}};
  const auto half = contours_in(halves, one);
  ASSERT_TRUE(half) << half.error();
  const geometry::Box box = geometry::bounding_box(half->contours.front().points_px);
  EXPECT_NEAR(box.min.x(), 159.5, 1.5);
  EXPECT_NEAR(box.max.x(), 319.5, 1.5);
}

TEST(Things, ScenesAreRefusedWithTheRemedy) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    cv::Mat scene = texture({640, 480}, {20, 60, 30}, {220, 200, 240}, seed);
    add_grain(scene, 5.0);
    const auto found = contours_in(scene, {});
    ASSERT_FALSE(found) << seed;
    EXPECT_NE(found.error().find("--at X,Y"), std::string::npos) << found.error();
    EXPECT_NE(found.error().find("--box"), std::string::npos) << found.error();
  }
}

TEST(Things, PointingAtNothingSaysSo) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(200, 205, 210));
  add_grain(picture, 4.0);
  PictureRequest request;
  request.pointing.at = {{320, 240}};
  const auto found = contours_in(picture, request);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().find("--box"), std::string::npos) << found.error();
}

TEST(Things, AHoleIsNoPartOfTheMask) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(70, 80, 90));
  disc(picture, {320, 240}, 140, cv::Scalar(180, 190, 200));
  disc(picture, {320, 240}, 60, cv::Scalar(70, 80, 90));
  add_grain(picture, 4.0);
  const auto things = things_in(scene_of(picture, 640));
  ASSERT_TRUE(things) << things.error();
  EXPECT_EQ(things->mask.at<unsigned char>(240, 320), 0);
  EXPECT_EQ(things->mask.at<unsigned char>(240, 420), 255);
  EXPECT_EQ(things->mask.at<unsigned char>(240, 500), 0);
}

TEST(Things, ARoughOutlineIsMovedOntoTheEdge) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(70, 80, 90));
  disc(picture, {320, 240}, 140, cv::Scalar(180, 190, 200));
  cv::GaussianBlur(picture, picture, {}, 1.2);
  add_grain(picture, 4.0);
  const Scene scene = scene_of(picture, 320);
  cv::Mat rough(scene.lab.size(), CV_8U, cv::Scalar(0));
  cv::circle(rough, {160, 120}, 69, cv::Scalar(255), cv::FILLED);
  const Contours found = snapped_outlines(scene, rough, picture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(compare(found.front(), circle({320, 240}, 140)).rms_px, 0.5);
}

TEST(Things, InADrawingAtTakesTheContourThatItLiesOn) {
  cv::Mat picture(480, 640, CV_8U, cv::Scalar(235));
  cv::circle(picture, {200, 240}, 120, cv::Scalar(40), 5, cv::LINE_AA);
  cv::circle(picture, {480, 240}, 90, cv::Scalar(40), 5, cv::LINE_AA);
  cv::GaussianBlur(picture, picture, {}, 1.0);
  for (const Vec2& p : {Vec2(480, 151), Vec2(470, 250)}) {  // on its line, and within
    PictureRequest request;
    request.pointing.at = {p};
    const auto found = contours_in(picture, request);
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->mode, ExtractionMode::kStroke);
    ASSERT_EQ(found->contours.size(), 1u);
    EXPECT_LT(compare(found->contours[0], circle({480, 240}, 90)).rms_px, 0.3);
  }
}

TEST(Things, WhatLiesBeyondThePictureAndWhatIsNoPictureIsRefused) {
  const cv::Mat picture(240, 320, CV_8UC3, cv::Scalar(200, 205, 210));
  PictureRequest request;
  request.pointing.at = {{400, 20}};
  const auto beyond = contours_in(picture, request);
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().find("--at 400,20 lies beyond the picture, which has 320 x 240 pixels"),
            std::string::npos)
      << beyond.error();
  LoadRequest load;
  load.pointing = {{{3, 3}}, {}, {}};
  const auto drawing = load_contours("any.svg", load);
  ASSERT_FALSE(drawing);
  EXPECT_NE(drawing.error().find("are for pictures"), std::string::npos) << drawing.error();
}

TEST(Things, AnyPictureOfAnySizeIsFoundOrRefused) {
  cv::RNG rng(3);
  for (int round = 0; round < 60; ++round) {
    const cv::Size size(rng.uniform(8, 90), rng.uniform(8, 90));
    const int types[] = {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_32FC3};
    cv::Mat picture(size, types[round % 5]);
    rng.fill(picture, cv::RNG::UNIFORM, 0, round % 3 == 0 ? 2 : 255);
    if (round % 4 == 0) cv::GaussianBlur(picture, picture, {}, 4.0);
    PictureRequest request;
    if (round % 2 == 0) request.pointing.at = {{rng.uniform(0, size.width), rng.uniform(0, size.height)}};
    if (round % 7 == 0) request.pointing.box = Eigen::Vector4d(1, 1, size.width, size.height);
    if (round % 5 == 0) request.pointing.away = {{0, 0}};
    const auto found = contours_in(picture, request);
    if (!found) {
      EXPECT_GT(found.error().size(), 20u) << round;
      continue;
    }
    ASSERT_FALSE(found->contours.empty()) << round;
    EXPECT_TRUE(geometry::all_finite(found->contours.front().points_px)) << round;
  }
}

}  // namespace
}  // namespace telekerf::vision
