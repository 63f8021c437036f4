// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "slave/vision/imaging/region_sums.h"

namespace telekerf::imaging {
namespace {

cv::Mat random_grey(int rows, int columns, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat out(rows, columns, CV_8U);
  random.fill(out, cv::RNG::UNIFORM, 0, 256);
  return out;
}

GreySums naive(const cv::Mat& grey) {
  GreySums out;
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const std::uint64_t value = grey.at<std::uint8_t>(y, x);
      out += {1, value, value * value};
    }
  }
  return out;
}

TEST(GreySums, AreExactForEveryWidthAndHeight) {
  for (int width = 1; width < 140; ++width) {
    const cv::Mat grey = random_grey(3 + width % 67, width, static_cast<std::uint64_t>(width));
    ASSERT_EQ(grey_sums(grey), naive(grey)) << width;
  }
}

TEST(GreySums, AreExactForWhiteWiderThanALaneHolds) {
  const cv::Mat white(257, 9001, CV_8U, cv::Scalar(255));
  const std::uint64_t pixels = 257U * 9001U;
  EXPECT_EQ(grey_sums(white), (GreySums{pixels, 255 * pixels, 255 * 255 * pixels}));
}

TEST(GreySums, OfAPartOfAPictureAreThoseOfThePart) {
  const cv::Mat part = random_grey(90, 200, 3)(cv::Rect(17, 5, 101, 60));
  EXPECT_EQ(grey_sums(part), naive(part));
}

TEST(GreySums, HaveMeanAndVariance) {
  const cv::Mat grey = (cv::Mat_<std::uint8_t>(1, 4) << 10, 20, 30, 40);
  EXPECT_DOUBLE_EQ(grey_sums(grey).mean(), 25.0);
  EXPECT_DOUBLE_EQ(grey_sums(grey).variance(), 125.0);
  EXPECT_EQ(GreySums{}.mean(), 0.0);
  EXPECT_EQ(GreySums{}.variance(), 0.0);
  // Nothing cancels: an even grey has no variance at all.
  EXPECT_EQ(grey_sums(cv::Mat(960, 1280, CV_8U, cv::Scalar(201))).variance(), 0.0);
}

TEST(RegionSums, OfStripsAreThoseOfTheWhole) {
  const cv::Mat region = random_grey(123, 157, 8);
  RegionSums strips(region.cols, region.rows);
  for (int row = 0; row < region.rows;) {
    const int count = std::min(1 + row % 11, region.rows - row);
    strips.add_rows(region.rowRange(row, row + count));
    row += count;
    EXPECT_EQ(strips.rows(), row);
  }
  EXPECT_EQ(strips.tiles(), tile_sums(region));
  EXPECT_EQ(strips.all(), naive(region));
}

TEST(RegionSums, TilesCoverTheRegionOnceAndRowByRow) {
  const cv::Mat region = random_grey(83, 99, 9);
  const auto tiles = tile_sums(region);
  GreySums all;
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      const cv::Range rows(row * 83 / 8, (row + 1) * 83 / 8);
      const cv::Range columns(column * 99 / 8, (column + 1) * 99 / 8);
      const GreySums& tile = tiles[static_cast<std::size_t>(8 * row + column)];
      EXPECT_EQ(tile, naive(region(rows, columns)));
      all += tile;
    }
  }
  EXPECT_EQ(all, naive(region));
}

TEST(RegionSums, LeaveOutRowsBeyondTheRegion) {
  const cv::Mat region = random_grey(40, 64, 2);
  RegionSums sums(64, 32);
  sums.add_rows(region);
  EXPECT_EQ(sums.rows(), 32);
  EXPECT_EQ(sums.all(), naive(region.rowRange(0, 32)));
}

TEST(RegionSums, RefuseWhatIsNoGreyRegion) {
  EXPECT_THROW(grey_sums(cv::Mat(10, 10, CV_8UC3)), cv::Exception);
  EXPECT_THROW(RegionSums(7, 100), cv::Exception);
  EXPECT_THROW(RegionSums(100, 7), cv::Exception);
  EXPECT_NO_THROW(RegionSums(8, 8));
  RegionSums sums(64, 64);
  EXPECT_THROW(sums.add_rows(cv::Mat(1, 63, CV_8U)), cv::Exception);
}

}  // namespace
}  // namespace telekerf::imaging
