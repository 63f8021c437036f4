// SPDX-License-Identifier: Apache-2.0
// Drawings photographed: a sheet on a desk, hair over a region, thick pens, dots beside strokes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/load.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

geometry::Polyline blob(double size, const Vec2& centre) {
  geometry::Polyline out{{}, true};
  for (int i = 0; i < 720; ++i) {
    const double a = i * M_PI / 360;
    const double r =
        size * (1.0 + 0.12 * std::cos(2 * a + 0.5) + 0.08 * std::sin(3 * a) + 0.04 * std::cos(5 * a));
    out.points_m.push_back(centre + r * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

std::vector<cv::Point> in_sixteenths(const geometry::Polyline& line) {
  std::vector<cv::Point> out;
  for (const Vec2& p : line.points_m)
    out.emplace_back(static_cast<int>(std::lround(16 * p.x())), static_cast<int>(std::lround(16 * p.y())));
  return out;
}

void fill(cv::Mat& picture, const geometry::Polyline& line, double grey) {
  cv::fillPoly(picture, std::vector{in_sixteenths(line)}, cv::Scalar(grey), cv::LINE_AA, 4);
}

void stroke(cv::Mat& picture, const geometry::Polyline& line, int pen, double grey) {
  cv::polylines(picture, std::vector{in_sixteenths(line)}, line.closed, cv::Scalar(grey), pen, cv::LINE_AA,
                4);
}

void photograph(cv::Mat& picture, double blur = 1.2, double sigma = 3.0) {
  cv::GaussianBlur(picture, picture, {}, blur);
  cv::RNG rng(7);
  cv::Mat grain(picture.size(), CV_16S);
  rng.fill(grain, cv::RNG::NORMAL, 0.0, sigma);
  cv::Mat wide;
  picture.convertTo(wide, CV_16S);
  wide += grain;
  wide.convertTo(picture, CV_8U);
}

/// Boards with a wavy grain.
cv::Mat desk(int period) {
  cv::Mat out(600, 800, CV_8U);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      out.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(
          62 + 26 * std::sin(2 * M_PI * (y + 12 * std::sin(x / 90.0)) / period));
    }
  }
  return out;
}

TEST(Surroundings, ASheetOnADeskIsBackground) {
  const geometry::Polyline truth = blob(120, {400, 300});
  for (const int period : {23, 44, 80}) {
    for (const int pen : {4, 7}) {
      cv::Mat picture = desk(period);
      cv::fillConvexPoly(picture, std::vector<cv::Point>{{95, 62}, {718, 88}, {700, 545}, {82, 520}},
                         cv::Scalar(225), cv::LINE_AA);
      stroke(picture, truth, pen, 40);
      photograph(picture);
      const auto found = contours_in(picture, {});
      ASSERT_TRUE(found) << found.error() << " period " << period;
      ASSERT_EQ(found->contours.size(), 1u);
      EXPECT_TRUE(found->contours.front().closed);
      EXPECT_LT(compare(found->contours.front(), truth).rms_px, 0.5);
      EXPECT_NE(found->why.find("sheet"), std::string::npos) << found->why;
    }
  }
}

TEST(Surroundings, ThePaperSaysSizeAndPerspective) {
  // An A4 sheet drawn straight on, 4 px a millimetre, with a circle of 30 mm radius; then seen askew.
  cv::Mat flat(840, 1188, CV_8U, cv::Scalar(228));
  cv::circle(flat, {500, 400}, 120, cv::Scalar(40), 5, cv::LINE_AA);
  for (const bool askew : {false, true}) {
    const std::vector<cv::Point2f> from{{-0.5F, -0.5F}, {1187.5F, -0.5F}, {1187.5F, 839.5F}, {-0.5F, 839.5F}};
    std::vector<cv::Point2f> to{{110, 70}, {880, 70}, {880, 614.4F}, {110, 614.4F}};
    if (askew) to = {{180, 90}, {850, 110}, {930, 640}, {90, 600}};
    cv::Mat picture(700, 1000, CV_8U, cv::Scalar(70));
    cv::warpPerspective(flat, picture, cv::getPerspectiveTransform(from, to), picture.size(), cv::INTER_AREA,
                        cv::BORDER_TRANSPARENT);
    photograph(picture, 0.8);
    LoadRequest request;
    request.paper = Paper::kA4;
    const auto found = contours_of(picture, request);
    ASSERT_TRUE(found) << found.error();
    ASSERT_EQ(found->contours.size(), 1u);
    EXPECT_NEAR(geometry::length_m(found->contours.front()), 2 * M_PI * 30e-3, 1e-3) << askew;
    const Vec2 size = geometry::bounding_box(found->contours.front().points_m).size();
    EXPECT_NEAR(size.x(), 60e-3, 0.4e-3);
    EXPECT_NEAR(size.y(), 60e-3, 0.4e-3);
  }
  LoadRequest request;
  request.paper = Paper::kA5;
  const auto none = contours_of(cv::Mat(300, 400, CV_8U, cv::Scalar(200)), request);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().find("--width-mm"), std::string::npos) << none.error();
}

TEST(Surroundings, ALightPlateWithHolesOnAnEvenGroundStaysAPlate) {
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(40));
  cv::rectangle(picture, {150, 120}, {650, 480}, cv::Scalar(225), cv::FILLED);
  cv::circle(picture, {300, 300}, 60, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  cv::circle(picture, {500, 300}, 60, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  photograph(picture);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 3u);
  EXPECT_NEAR(geometry::bounding_box(found->contours.front().points_px).size().x(), 501.0, 1.5);
}

TEST(Surroundings, HairOverALesionIsNoPartOfIt) {
  for (const double ink : {90.0, 110.0}) {
    const geometry::Polyline truth = blob(170, {400, 310});
    cv::Mat picture(600, 800, CV_8U, cv::Scalar(190));
    fill(picture, truth, ink);
    cv::GaussianBlur(picture, picture, {}, 3.0);
    cv::RNG rng(11);
    for (int hair = 0; hair < 9; ++hair) {
      geometry::Polyline line;
      const double y = rng.uniform(120, 500);
      const double rise = rng.uniform(20, 70);
      const double length = rng.uniform(80, 160);
      for (int x = hair % 2 == 0 ? -10 : 60; x < 700 + 30 * hair; x += 8)
        line.points_m.emplace_back(x, y + rise * std::sin(x / length + hair));
      stroke(picture, line, 3, 45);
    }
    photograph(picture, 0.8);
    const auto found = contours_in(picture, {});
    ASSERT_TRUE(found) << found.error();
    ASSERT_EQ(found->contours.size(), 1u) << ink;
    const Comparison c = compare(found->contours.front(), truth);
    EXPECT_LT(c.rms_px, 1.5) << ink;
    EXPECT_NEAR(c.length_ratio, 1.0, 0.02) << ink;
    EXPECT_NE(found->why.find("hair"), std::string::npos) << found->why;
  }
}

TEST(Surroundings, AThickPenIsOneLine) {
  const geometry::Polyline truth = blob(190, {400, 300});
  for (const int pen : {30, 42, 50}) {
    cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
    stroke(picture, truth, pen, 35);
    photograph(picture);
    const auto found = contours_in(picture, {});
    ASSERT_TRUE(found) << found.error();
    ASSERT_EQ(found->contours.size(), 1u) << pen;
    EXPECT_TRUE(found->contours.front().closed);
    EXPECT_LT(compare(found->contours.front(), truth).rms_px, 0.8) << pen;
  }
}

TEST(Surroundings, ARingWithAnUnevenRimIsARegion) {
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
  cv::circle(picture, {400, 300}, 220, cv::Scalar(35), cv::FILLED, cv::LINE_AA);
  cv::circle(picture, {440, 300}, 150, cv::Scalar(235), cv::FILLED, cv::LINE_AA);
  photograph(picture);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->contours.size(), 2u);
  EXPECT_EQ(found->mode, ExtractionMode::kOutline);
}

TEST(Surroundings, DashesAreCutAlongTheirMiddle) {
  const geometry::Polyline line = blob(200, {400, 300});
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
  int dashes = 0;
  for (std::size_t i = 0; i + 18 < line.size(); i += 30, ++dashes) {
    geometry::Polyline dash;
    dash.points_m.assign(line.points_m.begin() + static_cast<std::ptrdiff_t>(i),
                         line.points_m.begin() + static_cast<std::ptrdiff_t>(i + 18));
    stroke(picture, dash, 5, 35);
  }
  photograph(picture);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->mode, ExtractionMode::kStroke);
  ASSERT_EQ(found->contours.size(), static_cast<std::size_t>(dashes));
  for (const PixelContour& dash : found->contours) EXPECT_FALSE(dash.closed);
}

TEST(Surroundings, ASheetAskewOnEvenGroundIsPaperEvenUnderAFilledShape) {
  const geometry::Polyline truth = blob(110, {400, 300});
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(38));
  cv::fillConvexPoly(picture, std::vector<cv::Point>{{100, 60}, {730, 90}, {700, 550}, {70, 500}},
                     cv::Scalar(228), cv::LINE_AA);
  fill(picture, truth, 45);
  photograph(picture);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 1u);
  EXPECT_LT(compare(found->contours.front(), truth).rms_px, 0.8);
}

TEST(Surroundings, AFaintShadowOverARegionChangesNothing) {
  const geometry::Polyline truth = blob(180, {400, 300});
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
  fill(picture, truth, 50);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < 430 - y / 5; ++x)
      picture.at<unsigned char>(y, x) =
          cv::saturate_cast<unsigned char>(0.7 * picture.at<unsigned char>(y, x));
  }
  photograph(picture, 1.5);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 1u);
  EXPECT_LT(compare(found->contours.front(), truth).rms_px, 0.8);
}

TEST(Surroundings, DotsBesideStrokesKeepTheirOutlines) {
  const geometry::Polyline line = blob(200, {400, 300});
  const geometry::Polyline dot = blob(45, {410, 290});
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
  stroke(picture, line, 6, 35);
  fill(picture, dot, 35);
  photograph(picture);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 2u);
  EXPECT_TRUE(found->contours[0].closed && found->contours[1].closed);
  EXPECT_LT(compare(found->contours[0], line).rms_px, 0.4);
  EXPECT_LT(compare(found->contours[1], dot).rms_px, 0.8);
}

TEST(Surroundings, WhatIsTrimmedToItsSizeGetsRoom) {
  // A ring that reaches all four sides, on white and on nothing.
  cv::Mat white(401, 401, CV_8U, cv::Scalar(255));
  cv::circle(white, {200, 200}, 200, cv::Scalar(20), cv::FILLED);
  cv::circle(white, {200, 200}, 120, cv::Scalar(255), cv::FILLED);
  cv::Mat nothing(401, 401, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  cv::circle(nothing, {200, 200}, 200, cv::Scalar(40, 90, 200, 255), cv::FILLED);
  cv::circle(nothing, {200, 200}, 120, cv::Scalar(0, 0, 0, 0), cv::FILLED);
  for (const cv::Mat& picture : {white, nothing}) {
    const auto found = contours_in(picture, {});
    ASSERT_TRUE(found) << found.error();
    ASSERT_EQ(found->contours.size(), 2u);
    const geometry::Box box = geometry::bounding_box(found->contours.front().points_px);
    EXPECT_NEAR(box.centre().x(), 200.0, 0.3);
    EXPECT_NEAR(box.size().x(), 401.0, 2.0);
    EXPECT_EQ(found->picture_width_px, 401);
  }
}

TEST(Surroundings, WhatIsLeftOutIsNamedWithTheOptionThatKeepsIt) {
  cv::Mat picture(600, 800, CV_8U, cv::Scalar(235));
  fill(picture, blob(150, {330, 300}), 35);
  fill(picture, blob(150, {800, 300}), 35);  // runs over the border
  cv::circle(picture, {560, 540}, 7, cv::Scalar(35), cv::FILLED, cv::LINE_AA);
  photograph(picture);
  LoadRequest request;
  request.scale.picture_width_m = 0.08;
  const auto found = contours_of(picture, request);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->contours.size(), 1u);
  EXPECT_NE(found->why.find("touches the picture's border"), std::string::npos) << found->why;
  EXPECT_NE(found->why.find("--at"), std::string::npos) << found->why;
  EXPECT_NE(found->why.find("1 small contour"), std::string::npos) << found->why;
  EXPECT_NE(found->why.find("--smallest-mm"), std::string::npos) << found->why;
  request.smallest_m = 1e-3;
  const auto more = contours_of(picture, request);
  ASSERT_TRUE(more) << more.error();
  ASSERT_EQ(more->contours.size(), 2u);
  EXPECT_NEAR(geometry::length_m(more->contours.back()), 2 * M_PI * 0.7e-3, 0.2e-3);
  EXPECT_EQ(more->why.find("small contour"), std::string::npos) << more->why;
}

}  // namespace
}  // namespace telekerf::vision
