// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slave/vision/imaging/sharpness.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

cv::Mat eight(const cv::Mat& fine) {
  cv::Mat out;
  fine.convertTo(out, CV_8U);
  return out;
}

cv::Mat noisy(const cv::Mat& fine, double deviation, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat noise(fine.size(), CV_32F);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  return eight(fine + noise);
}

cv::Mat tissue(double blur_px = 1.0) {
  cv::Mat out = draw_target(Target::kTissue, 256, 1.0, 5);
  cv::GaussianBlur(out, out, {}, blur_px);
  return out;
}

TEST(NormalisedVariance, IsEquation155) {
  const cv::Mat grey = (cv::Mat_<std::uint8_t>(1, 4) << 10, 20, 30, 40);
  EXPECT_DOUBLE_EQ(normalised_variance(grey_sums(grey)), 125.0 / 25.0);
}

TEST(NormalisedVariance, OfBlackIsNothing) {
  EXPECT_EQ(normalised_variance(grey_sums(cv::Mat(64, 64, CV_8U, cv::Scalar(0)))), 0.0);
  const Sharpness black = sharpness_of(cv::Mat(64, 64, CV_8U, cv::Scalar(0)), {});
  EXPECT_EQ(black.variance, 0.0);
  EXPECT_EQ(black.tenengrad, 0.0);
  EXPECT_EQ(black.mean, 0.0);
}

TEST(Sharpness, OfAnEvenPictureIsNothing) {
  const Sharpness even = sharpness_of(cv::Mat(70, 90, CV_8U, cv::Scalar(130)), {});
  EXPECT_EQ(even.variance, 0.0);
  EXPECT_EQ(even.tenengrad, 0.0);
  EXPECT_DOUBLE_EQ(even.mean, 130.0);
}

TEST(Sharpness, OfARampIsItsSlope) {
  // 2 grey levels a pixel to the right: Sobel gives 8 x 2, squared 256, over the square of each tile's mean.
  cv::Mat ramp(64, 64, CV_8U);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) ramp.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(40 + 2 * x);
  }
  const Sharpness seen = sharpness_of(ramp, {});
  // 54 of 64 tiles count: those of the darkest column, whose slope weighs most, are left out, and 2 of the
  // next.
  double slope = 0.0;
  double variance = 0.0;
  for (int column = 1; column < 8; ++column) {
    const double mean = 40.0 + 2.0 * (8 * column + 3.5);
    const int tiles = column == 1 ? 6 : 8;
    slope += tiles * 256.0 / (mean * mean) / 54.0;
    variance += tiles * 21.0 / (mean * mean) / 54.0;  // of 8 steps of 2: 4 (64 - 1) / 12
  }
  EXPECT_NEAR(seen.tenengrad, slope, 1e-12);
  EXPECT_NEAR(seen.variance, variance, 1e-12);
}

TEST(Sharpness, FallsWithBlur) {
  double variance = 1e9;
  double tenengrad = 1e9;
  for (const double blur : {0.6, 1.0, 1.6, 2.5, 4.0, 7.0}) {
    const Sharpness seen = sharpness_of(eight(tissue(blur)), {});
    EXPECT_LT(seen.variance, variance);
    EXPECT_LT(seen.tenengrad, tenengrad);
    // The variance sees further, the gradient is steeper.
    EXPECT_TRUE(variance == 1e9 || seen.tenengrad / tenengrad < seen.variance / variance) << blur;
    variance = seen.variance;
    tenengrad = seen.tenengrad;
  }
}

TEST(Sharpness, DoesNotCountTheGain) {
  const Sharpness full = sharpness_of(eight(tissue()), {});
  const Sharpness half = sharpness_of(eight(0.5 * tissue()), {});
  EXPECT_NEAR(half.variance / full.variance, 1.0, 0.01);
  EXPECT_NEAR(half.tenengrad / full.tenengrad, 1.0, 0.02);
}

TEST(Sharpness, HasTheNoiseTakenOut) {
  const Sharpness clean = sharpness_of(eight(tissue()), {});
  for (const double deviation : {2.0, 6.0}) {
    const cv::Mat picture = noisy(tissue(), deviation, 7);
    const Background background{.noise_variance = deviation * deviation, .flat = {}};
    const Sharpness seen = sharpness_of(picture, background);
    EXPECT_NEAR(seen.variance, clean.variance, 5.0 * seen.variance_deviation + 0.01 * clean.variance);
    EXPECT_NEAR(seen.tenengrad, clean.tenengrad, 5.0 * seen.tenengrad_deviation + 0.01 * clean.tenengrad);
    EXPECT_GT(sharpness_of(picture, {}).tenengrad, clean.tenengrad + 20.0 * seen.tenengrad_deviation);
  }
}

TEST(Sharpness, KnowsItsOwnDeviation) {
  const double deviation = 4.0;
  const Background background{.noise_variance = deviation * deviation, .flat = {}};
  double variance = 0.0;
  double tenengrad = 0.0;
  double variances = 0.0;
  double tenengrads = 0.0;
  Sharpness one;
  constexpr int kPictures = 60;
  for (int i = 0; i < kPictures; ++i) {
    one = sharpness_of(noisy(tissue(), deviation, static_cast<std::uint64_t>(100 + i)), background);
    variance += one.variance / kPictures;
    tenengrad += one.tenengrad / kPictures;
    variances += one.variance * one.variance / kPictures;
    tenengrads += one.tenengrad * one.tenengrad / kPictures;
  }
  const double spread = std::sqrt(variances - variance * variance);
  const double slopes_spread = std::sqrt(tenengrads - tenengrad * tenengrad);
  EXPECT_GT(one.variance_deviation, 0.6 * spread);
  EXPECT_LT(one.variance_deviation, 1.7 * spread);
  EXPECT_GT(one.tenengrad_deviation, 0.6 * slopes_spread);
  EXPECT_LT(one.tenengrad_deviation, 2.5 * slopes_spread);
}

TEST(Sharpness, HasTheFlatFieldTakenOut) {
  cv::Mat light(256, 256, CV_32F);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const double r2 = std::pow(x / 127.5 - 1.0, 2) + std::pow(y / 127.5 - 1.0, 2);
      light.at<float>(y, x) = static_cast<float>(1.0 - 0.3 * r2 / 2.0);
    }
  }
  const cv::Mat paper = eight(200.0 * light);
  const double with = sharpness_of(paper, {}).variance;
  const double without = sharpness_of(paper, {.noise_variance = 0.0, .flat = flat_of(light)}).variance;
  EXPECT_GT(with, 1e-4);
  EXPECT_LT(without, 0.05 * with);
}

TEST(FlatOf, IsTheVarianceWithinEachTile) {
  cv::RNG random(4);
  cv::Mat light(91, 117, CV_64F);  // tiles of unequal sizes
  random.fill(light, cv::RNG::UNIFORM, 0.5, 1.5);
  const auto flat = flat_of(light);
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      const cv::Mat tile = light(cv::Range(row * 91 / 8, (row + 1) * 91 / 8),
                                 cv::Range(column * 117 / 8, (column + 1) * 117 / 8));
      cv::Scalar mean;
      cv::Scalar deviation;
      cv::meanStdDev(tile, mean, deviation);
      EXPECT_NEAR(flat[static_cast<std::size_t>(8 * row + column)], std::pow(deviation[0] / mean[0], 2), 1e-9)
          << row << ", " << column;
    }
  }
  const auto dark = flat_of(cv::Mat(64, 64, CV_64F, cv::Scalar(0.0)));
  for (const double value : dark) EXPECT_EQ(value, 0.0);
}

TEST(Sharpness, OfABlackTileIsNothing) {
  cv::Mat half = eight(tissue());
  half(cv::Rect(0, 0, 128, 256)).setTo(0);
  half.at<std::uint8_t>(3, 3) = 40;  // a hot pixel in the dark
  const Sharpness seen = sharpness_of(half, {});
  for (std::size_t tile = 0; tile < kTiles; ++tile) EXPECT_EQ(seen.tiles[tile] == 0.0, tile % 8 < 4) << tile;
}

TEST(Sharpness, OfATileOfOneGreyLevelCounts) {
  cv::Mat stripes(64, 64, CV_8U, cv::Scalar(0));
  for (int x = 0; x < 64; x += 2) stripes.col(x).setTo(2);  // mean 1, variance 1
  const Sharpness seen = sharpness_of(stripes, {.noise_variance = 0.5, .flat = {}});
  EXPECT_DOUBLE_EQ(seen.variance, 0.5);
  EXPECT_GT(seen.variance_deviation, 0.0);
  EXPECT_EQ(seen.tenengrad, 0.0);  // the stripes are finer than Sobel's arms
  for (int x = 0; x < 64; ++x) stripes.col(x).setTo(x / 4 % 2 == 0 ? 0 : 2);
  EXPECT_GT(sharpness_of(stripes, {}).tenengrad, 1.0);
}

TEST(Sharpness, IsTheMeanOfTheTilesWithoutTheLargestTen) {
  const cv::Mat picture = noisy(tissue(), 3.0, 2);
  const Background background{.noise_variance = 9.0, .flat = {}};
  const Sharpness seen = sharpness_of(picture, background);
  std::vector<double> tiles;
  double mean = 0.0;
  for (const GreySums& sums : tile_sums(picture)) {
    tiles.push_back((sums.variance() - 9.0) / (sums.mean() * sums.mean()));
    mean += sums.mean() / 64.0;
  }
  for (std::size_t i = 0; i < kTiles; ++i) EXPECT_NEAR(seen.tiles[i], tiles[i], 1e-15);
  EXPECT_NEAR(seen.mean, mean, 1e-9);
  std::sort(tiles.begin(), tiles.end());
  double sum = 0.0;
  for (int i = 0; i < 54; ++i) sum += tiles[static_cast<std::size_t>(i)];
  EXPECT_NEAR(seen.variance, sum / 54.0, 1e-12);
  // Of noise of variance v on a mean m: 2 v^2 + 4 v S m^2 over the pixels and m^4.
  const double noise = 9.0 / (mean * mean);
  EXPECT_NEAR(seen.variance_deviation,
              std::sqrt((2.0 * noise * noise + 4.0 * noise * seen.variance) / (256.0 * 256.0)), 1e-12);
  // Each gradient has 12 v of it in each direction, and four neighbours count as one.
  const double slope = 12.0 * noise;
  EXPECT_NEAR(seen.tenengrad_deviation,
              std::sqrt(4.0 * (4.0 * slope * slope + 4.0 * slope * seen.tenengrad) / (256.0 * 256.0)), 1e-12);
}

TEST(Sharpness, IsTheSquareOfBothSobelGradients) {
  const cv::Mat picture = noisy(tissue(), 3.0, 6)(cv::Rect(3, 5, 150, 134));
  cv::Mat across;
  cv::Mat down;
  cv::Sobel(picture, across, CV_64F, 1, 0);
  cv::Sobel(picture, down, CV_64F, 0, 1);
  std::vector<double> slopes;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      // The outermost pixels have none.
      const cv::Range rows(std::max(1, row * 134 / 8), std::min(133, (row + 1) * 134 / 8));
      const cv::Range columns(std::max(1, column * 150 / 8), std::min(149, (column + 1) * 150 / 8));
      const cv::Mat a = across(rows, columns);
      const cv::Mat d = down(rows, columns);
      const double mean = tile_sums(picture)[static_cast<std::size_t>(8 * row + column)].mean();
      slopes.push_back((a.dot(a) + d.dot(d)) / static_cast<double>(a.total()) / (mean * mean));
    }
  }
  std::sort(slopes.begin(), slopes.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < 54; ++i) sum += slopes[i];
  EXPECT_NEAR(sharpness_of(picture, {}).tenengrad, sum / 54.0, 1e-9 * sum);
}

TEST(Sharpness, LeavesOutSingleSpecks) {
  cv::Mat paper(256, 256, CV_32F, cv::Scalar(200));
  for (int i = 0; i < 8; ++i) cv::circle(paper, {16 + 32 * i, 16 + 32 * i}, 5, cv::Scalar(50), cv::FILLED);
  EXPECT_EQ(sharpness_of(eight(paper), {}).variance, 0.0);
  EXPECT_EQ(sharpness_of(eight(paper), {}).tenengrad, 0.0);
}

TEST(Sharpness, WithoutTenengradIsTheSameVariance) {
  const Sharpness both = sharpness_of(eight(tissue()), {});
  const Sharpness one = sharpness_of(eight(tissue()), {}, false);
  EXPECT_EQ(one.variance, both.variance);
  EXPECT_EQ(one.tenengrad, 0.0);
  EXPECT_GT(both.tenengrad, 0.0);
}

TEST(CentralRegion, LiesInTheMiddle) {
  EXPECT_EQ(central_region({1280, 960}, 0.5), cv::Rect(320, 240, 640, 480));
  EXPECT_EQ(central_region({1280, 960}, 1.0), cv::Rect(0, 0, 1280, 960));
  EXPECT_EQ(central_region({100, 100}, 0.1), cv::Rect(18, 18, 64, 64));  // never less than 64 pixels
  EXPECT_EQ(central_region({40, 30}, 0.5), cv::Rect(0, 0, 40, 30));
}

TEST(AtRest, TheDifferenceIsTheNoise) {
  for (const double deviation : {1.0, 3.0, 7.0}) {
    const RestPair pair = compare_at_rest(noisy(tissue(), deviation, 1), noisy(tissue(), deviation, 2));
    EXPECT_NEAR(pair.noise_variance, deviation * deviation + 1.0 / 12.0, 0.05 * deviation * deviation + 0.05);
    EXPECT_FALSE(pair.moved()) << pair.coherence_deviations;
  }
}

TEST(AtRest, LightThatChangesIsNoMovement) {
  const RestPair pair = compare_at_rest(noisy(tissue(), 2.0, 1), noisy(1.03 * tissue(), 2.0, 2));
  EXPECT_FALSE(pair.moved()) << pair.coherence_deviations;
}

TEST(AtRest, MovementIsSeenInFocusAndOut) {
  const cv::Mat fine = draw_target(Target::kTissue, 300, 1.0, 5);
  for (const double blur : {0.6, 2.0, 6.0}) {
    cv::Mat soft;
    cv::GaussianBlur(fine, soft, {}, blur);
    const cv::Mat here = soft(cv::Rect(10, 10, 256, 256));
    const cv::Mat there = soft(cv::Rect(12, 10, 256, 256));
    EXPECT_TRUE(compare_at_rest(noisy(here, 2.0, 1), noisy(there, 2.0, 2)).moved()) << blur;
  }
}

TEST(AtRest, TheCoherenceIsThatOfTheMeansOverBlocks) {
  const cv::Mat a = noisy(tissue(), 2.0, 1)(cv::Rect(0, 0, 101, 67));
  const cv::Mat b = noisy(tissue(1.3), 2.0, 2)(cv::Rect(0, 0, 101, 67));
  cv::Mat difference;
  cv::subtract(a, b * 1.0, difference, cv::noArray(), CV_64F);
  const double gain = cv::mean(a)[0] / cv::mean(b)[0];
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x)
      difference.at<double>(y, x) = a.at<std::uint8_t>(y, x) - gain * b.at<std::uint8_t>(y, x);
  }
  const double variance = difference.dot(difference) / (101.0 * 67.0);
  double most = 0.0;
  for (const int block : {2, 8}) {
    double squares = 0.0;
    int count = 0;
    for (int y = 0; y + block <= 67; y += block) {
      for (int x = 0; x + block <= 101; x += block, ++count)
        squares += std::pow(cv::mean(difference(cv::Rect(x, y, block, block)))[0], 2);
    }
    most = std::max(most, (block * block * squares / count / variance - 1.0) / std::sqrt(2.0 / count));
  }
  const RestPair pair = compare_at_rest(a, b);
  EXPECT_GT(most, 1.0);
  EXPECT_NEAR(pair.coherence_deviations, most, 1e-3 * most);
  EXPECT_NEAR(pair.noise_variance, 0.5 * variance, 1e-3 * variance);
}

TEST(AtRest, TheSamePictureTwiceHasNoNoiseAndHasNotMoved) {
  const cv::Mat picture = eight(tissue());
  const RestPair pair = compare_at_rest(picture, picture);
  EXPECT_EQ(pair.noise_variance, 0.0);
  EXPECT_FALSE(pair.moved());
}

}  // namespace
}  // namespace telekerf::imaging
