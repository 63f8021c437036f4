// SPDX-License-Identifier: Apache-2.0
// Planes, levels, noise and light of pictures that are made for it.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "common/vision/raster/edge_evidence.h"
#include "common/vision/raster/grey_plane.h"
#include "common/vision/raster/levels.h"
#include "common/vision/raster/light.h"
#include "tests/unit/vision/fields.h"

namespace telekerf::vision {
namespace {

TEST(Levels, HistogramCountsEveryPixelOrAQuarterOfALargePicture) {
  cv::RNG rng(3);
  for (const cv::Size size :
       {cv::Size(61, 40), cv::Size(130, 999), cv::Size(517, 1000), cv::Size(64, 1003)}) {
    cv::Mat plane(size, CV_8U);
    rng.fill(plane, cv::RNG::UNIFORM, 0, 256);
    Histogram expected{};
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        // Of a large picture each row has every fourth stretch of 64 columns, another one than its
        // neighbours.
        if (size.height < 1000 || x / 64 % 4 == y % 4) expected[plane.at<unsigned char>(y, x)] += 1.0;
      }
    }
    EXPECT_EQ(histogram_of(plane), expected) << size;
  }
}

Histogram two_levels(double low, double high) {
  Histogram counts{};
  counts[100] = low;
  counts[200] = high;
  return counts;
}

TEST(Levels, OtsuSplitsTwoClasses) {
  const Split split = otsu(two_levels(60, 40));
  EXPECT_EQ(split.level, 100.5);
  EXPECT_EQ(split.low_mean, 100.0);
  EXPECT_EQ(split.high_mean, 200.0);
  EXPECT_TRUE(split.clear);
  EXPECT_FALSE(otsu(two_levels(95, 5)).clear) << "a twentieth is not large";
  EXPECT_TRUE(otsu(two_levels(94.9, 5.1)).clear);
  EXPECT_TRUE(otsu(two_levels(5.1, 94.9)).clear);
  EXPECT_FALSE(otsu(two_levels(5, 95)).clear);
  // Each class spread by +-d: of all variance 50^2 + d^2 that between them is 50^2, nine tenths at d = 16.67.
  for (const auto& [d, clear] : {std::pair{16, true}, {17, false}}) {
    Histogram counts{};
    for (const int middle : {100, 200}) counts[middle - d] = counts[middle + d] = 25;
    const Split spread = otsu(counts);
    EXPECT_EQ(spread.level, 100.5 + d);
    EXPECT_EQ(spread.low_mean, 100.0);
    EXPECT_EQ(spread.clear, clear) << d;
  }
}

TEST(Levels, PercentilesLieWithinTheirLevel) {
  Histogram counts{};
  counts[10] = counts[20] = 4;
  counts[30] = 100;
  for (const auto& [fraction, level] :
       {std::pair{0.0, 9.5}, {0.25, 10.0}, {0.5, 10.5}, {0.75, 20.0}, {1.0, 20.5}})
    EXPECT_DOUBLE_EQ(percentile(counts, 5, 25, fraction), level) << fraction;
  EXPECT_DOUBLE_EQ(percentile(counts, 10, 20, 0.25), 10.0) << "both ends count";
  EXPECT_EQ(percentile(counts, 40, 50, 0.5), 50.0) << "of nothing";
}

TEST(Noise, IsToldToAFewPerCentAndEdgesDoNotCount) {
  cv::RNG rng(5);
  for (const double sigma : {1.5, 4.0, 10.0, 30.0}) {
    cv::Mat noise(480, 640, CV_32F);
    rng.fill(noise, cv::RNG::NORMAL, 0.0, sigma);
    cv::Mat picture(480, 640, CV_8U);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x)
        picture.at<unsigned char>(y, x) =
            cv::saturate_cast<unsigned char>((x / 80 % 2 == 0 ? 115 : 135) + noise.at<float>(y, x));
    }
    EXPECT_NEAR(noise_of(picture) / std::hypot(sigma, 1.0 / std::sqrt(12.0)), 1.0, 0.04) << sigma;
  }
  EXPECT_EQ(noise_of(cv::Mat(480, 640, CV_8U, cv::Scalar(90))), 0.0);
}

cv::Mat lit(const Light& light, int cols, int rows) {
  cv::Mat out(rows, cols, CV_8U);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      const double u = (x + 0.5) / cols - 0.5, v = (y + 0.5) / rows - 0.5;
      Light row;
      row << 1.0, u, v, u * u, u * v, v * v;
      out.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(row.dot(light));
    }
  }
  return out;
}

TEST(Light, IsFoundAsItWasAndTakenOut) {
  Light light;
  light << 160.0, 40.0, -24.0, 30.0, 20.0, -36.0;
  EXPECT_DOUBLE_EQ(change_of(light), 0.5 * (40 + 24) + 0.25 * (30 + 20 + 36));
  cv::Mat picture = lit(light, 640, 480);
  const auto found = light_of(picture, 0.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found)[0], light[0], 0.5);
  for (int k = 1; k < 6; ++k) EXPECT_NEAR((*found)[k], light[k], 2.0) << k;
  const cv::Mat flat = flattened(picture, light);
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(flat, &low, &high);
  EXPECT_GE(low, 158.0);
  EXPECT_LE(high, 162.0);
  // A drawing on a third of it changes nothing; on two thirds there is no light to be found.
  picture(cv::Rect(0, 0, 213, 480)) = 20;
  const auto beside = light_of(picture, 0.0);
  ASSERT_TRUE(beside);
  EXPECT_NEAR((*beside)[0], light[0], 1.5);
  EXPECT_NEAR((*beside)[1], light[1], 6.0);
  picture(cv::Rect(0, 0, 300, 480)) = 20;
  EXPECT_FALSE(light_of(picture, 0.0));
}

TEST(Light, FlattenedStaysWithinItsBytes) {
  Light light = Light::Zero();
  light[1] = 100.0;
  const cv::Mat dark(64, 640, CV_8U, cv::Scalar(3)), bright(64, 640, CV_8U, cv::Scalar(250));
  for (int x : {16, 624}) {
    const double change = x < 320 ? -47.5 : 47.5;
    EXPECT_NEAR(flattened(dark, light).at<unsigned char>(9, x), change < 0 ? 3 + 47.5 : 0, 1.0) << x;
    EXPECT_NEAR(flattened(bright, light).at<unsigned char>(9, x), change < 0 ? 255 : 250 - 47.5, 1.0) << x;
  }
}

TEST(Field, ValuesAreSignedAndBilinear) {
  Field field =
      field_of(4, 3, 100.0, [](int x, int y) { return 10 * x + 50 * y + (x == 2 && y == 2 ? 7 : 0); });
  EXPECT_EQ(field.value(1, 2), 10.0);
  EXPECT_DOUBLE_EQ(field.value(Vec2(0.25, 0.5)), 2.5 + 25.0 - 100.0);
  EXPECT_DOUBLE_EQ(field.value(Vec2(1.5, 1.5)), 15.0 + 75.0 + 7.0 / 4.0 - 100.0);
  EXPECT_DOUBLE_EQ(field.value(Vec2(2.999, 1.0)), 29.99 + 50.0 - 100.0);
  for (const Vec2& beyond : {Vec2(-0.01, 1), Vec2(1, -0.01), Vec2(3.0, 1), Vec2(1, 2.0)})
    EXPECT_EQ(field.value(beyond), -1.0) << beyond.transpose();
  field.dark = true;
  EXPECT_EQ(field.value(1, 2), -10.0);
  EXPECT_DOUBLE_EQ(field.value(Vec2(0.25, 0.5)), 72.5);
}

TEST(Field, LevelLiesHalfWayBetweenDrawingAndBackground) {
  for (const bool dark : {true, false}) {
    cv::Mat picture(300, 400, CV_8U, cv::Scalar(dark ? 200 : 60));
    picture(cv::Rect(100, 80, 180, 120)) = dark ? 60 : 200;
    const auto field = make_field(picture);
    ASSERT_TRUE(field);
    EXPECT_EQ(field->dark, dark);
    EXPECT_NEAR(field->level, 130.0, 1.01);
    EXPECT_NEAR(field->contrast, 140.0, 1.5);
    EXPECT_EQ(field->noise, 0.0);
    EXPECT_EQ(field->sigma_px, 1.0);
    const int drawn = 180 * 120 - 4;  // the blur takes the corners
    EXPECT_EQ(cv::countNonZero(field->drawn), drawn);
    const Field other = inverted(*field);
    EXPECT_EQ(cv::countNonZero(other.drawn), 400 * 300 - drawn);
    EXPECT_NE(other.dark, field->dark);
    EXPECT_EQ(cv::countNonZero(field->drawn), drawn) << "the copy has planes of its own";
    EXPECT_DOUBLE_EQ(edge_evidence(*field).explained, 1.0);
  }
}

TEST(Field, TheBackgroundIsWhatMostOfTheBorderShows) {
  cv::Mat picture(10, 10, CV_8U, cv::Scalar(200));
  EXPECT_FALSE(border_is_dark(picture, 100));
  picture.row(0) = 0;  // 10 + 2 of 40: corners count twice
  EXPECT_FALSE(border_is_dark(picture, 100));
  picture(cv::Rect(0, 0, 1, 8)) = 0;
  EXPECT_FALSE(border_is_dark(picture, 100)) << "19";
  picture(cv::Rect(0, 0, 1, 9)) = 0;
  EXPECT_TRUE(border_is_dark(picture, 100)) << "half";
  EXPECT_FALSE(border_is_dark(picture, 0)) << "below the level, not on it";
}

TEST(GreyPlane, TakesAnyDepthAndNamesWhatItCannot) {
  EXPECT_TRUE(grey_plane(cv::Mat(8, 8, CV_8U, cv::Scalar(7))));
  EXPECT_EQ(grey_plane(cv::Mat(8, 7, CV_8U, cv::Scalar(7))).error(),
            "the picture has only 7 x 8 pixels; at least 8 x 8 are needed");
  EXPECT_FALSE(grey_plane(cv::Mat(7, 8, CV_8U, cv::Scalar(7))));
  EXPECT_EQ(grey_plane(cv::Mat(9, 9, CV_8UC2, cv::Scalar(7, 7))).error(),
            "the picture has 2 channels; 1, 3 or 4 are understood");
  EXPECT_EQ(grey_plane(cv::Mat()).error(), "the picture is empty");
  // 16 bits: from the smallest to the largest value but for a hot pixel among 50 000.
  cv::Mat wide(250, 400, CV_16U, cv::Scalar(1000));
  wide(cv::Rect(0, 0, 200, 250)) = 5000;
  wide(cv::Rect(390, 0, 10, 250)) = 3000;
  wide.at<std::uint16_t>(9, 399) = 65535;
  const cv::Mat narrow = *grey_plane(wide);
  EXPECT_EQ(narrow.at<unsigned char>(0, 0), 255);
  EXPECT_EQ(narrow.at<unsigned char>(0, 250), 0);
  EXPECT_NEAR(narrow.at<unsigned char>(0, 395), 127.5, 0.5);
  cv::Mat real(20, 20, CV_32F, cv::Scalar(-2.0));
  real.at<float>(3, 3) = 2.0F;
  real.at<float>(5, 5) = NAN;  // 0
  const cv::Mat bytes = *grey_plane(real);
  EXPECT_EQ(bytes.at<unsigned char>(3, 3), 255);
  EXPECT_EQ(bytes.at<unsigned char>(0, 0), 0);
  EXPECT_NEAR(bytes.at<unsigned char>(5, 5), 127.5, 0.5);
  EXPECT_EQ(cv::countNonZero(*grey_plane(cv::Mat(20, 20, CV_32F, cv::Scalar(5.0)))), 0) << "one level alone";
}

TEST(GreyPlane, AlphaLiesOverWhite) {
  cv::Mat painted(10, 10, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  painted.at<cv::Vec4b>(2, 2) = {0, 0, 0, 255};
  painted.at<cv::Vec4b>(3, 3) = {0, 0, 0, 51};
  const cv::Mat plane = *grey_plane(painted);
  EXPECT_EQ(plane.at<unsigned char>(0, 0), 255);
  EXPECT_EQ(plane.at<unsigned char>(2, 2), 0);
  EXPECT_EQ(plane.at<unsigned char>(3, 3), 204);
  cv::Mat white(10, 10, CV_8UC4, cv::Scalar(255, 255, 255, 0));
  white.at<cv::Vec4b>(2, 2) = {255, 255, 255, 100};
  EXPECT_EQ(grey_plane(white)->at<unsigned char>(2, 2), 155) << "a white drawing is its alpha";
}

}  // namespace
}  // namespace telekerf::vision
