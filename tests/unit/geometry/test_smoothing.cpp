// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/geometry/smoothing.h"

namespace telekerf::geometry {
namespace {

constexpr double kRadius = 40.0;  ///< spacings

std::vector<Vec2> circle() {
  const auto n = static_cast<std::size_t>(std::lround(2.0 * M_PI * kRadius));
  std::vector<Vec2> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = 2.0 * M_PI * static_cast<double>(i) / static_cast<double>(n);
    out.emplace_back(kRadius * std::cos(a), kRadius * std::sin(a));
  }
  return out;
}

double largest_distance(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, (a[i] - b[i]).norm());
  return out;
}

TEST(Smoothing, AGaussianFlattensABendAndTwiceOneKeepsIt) {
  for (const double sigma : {1.0, 2.5, 4.0}) {
    const std::vector<Vec2> before = circle();
    const std::vector<Vec2> flatter = gaussian_smoothed(before, true, sigma);
    const double shrinks = sigma * sigma / (2.0 * kRadius);
    for (const Vec2& p : flatter) EXPECT_NEAR(kRadius - p.norm(), shrinks, 0.02 * shrinks + 1e-3) << sigma;
    std::vector<Vec2> kept = before;
    smooth_keeping_bends(kept, true, sigma);
    EXPECT_LT(largest_distance(kept, before), 0.1 * shrinks) << sigma;
  }
}

TEST(Smoothing, AnOpenLineKeepsItsEndsAndAStraightOneEverything) {
  std::vector<Vec2> straight;
  std::vector<Vec2> bent;
  for (int i = 0; i < 60; ++i) {
    straight.emplace_back(0.6 * i, -0.8 * i);
    bent.emplace_back(i, std::sin(0.2 * i));
  }
  for (const double sigma : {0.7, 3.0, 14.0}) {  // the last reaches nearly along the line
    EXPECT_LT(largest_distance(gaussian_smoothed(straight, false, sigma), straight), 1e-9) << sigma;
    const std::vector<Vec2> out = gaussian_smoothed(bent, false, sigma);
    EXPECT_LT((out.front() - bent.front()).norm(), 1e-9) << sigma;
    EXPECT_LT((out.back() - bent.back()).norm(), 1e-9) << sigma;
  }
}

TEST(Smoothing, SaysHowMuchNoiseItTookAway) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::vector<Vec2> points = circle();
  for (Vec2& p : points) p += Vec2(noise(rng), noise(rng));
  const double taken = smooth_keeping_bends(points, true, 4.0);
  EXPECT_NEAR(taken, 0.2, 0.04);
  double left = 0.0;
  for (const Vec2& p : points) left += std::pow(p.norm() - kRadius, 2) / static_cast<double>(points.size());
  EXPECT_LT(std::sqrt(left), 0.1);
}

TEST(Smoothing, TheKernelReachesFourSigmaAndItsSumIsTheGaussians) {
  for (const double sigma : {1.0, 2.5, 4.1}) {
    const HalfKernel kernel = gaussian_kernel(sigma);
    ASSERT_EQ(kernel.weights.size(), static_cast<std::size_t>(std::ceil(4.0 * sigma)) + 1);
    EXPECT_NEAR(kernel.sum, std::sqrt(2.0 * M_PI) * sigma, 2e-4 * sigma);
    for (std::size_t k = 0; k < kernel.weights.size(); ++k) {
      const double u = static_cast<double>(k) / sigma;
      EXPECT_NEAR(kernel.weights[k], std::exp(-0.5 * u * u), 1e-15);
    }
  }
}

TEST(Smoothing, AClosedLineHasNoSeam) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  std::vector<Vec2> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(coordinate(rng), coordinate(rng));
  std::vector<Vec2> turned = points;
  std::rotate(turned.begin(), turned.begin() + 17, turned.end());
  std::vector<Vec2> expected = gaussian_smoothed(points, true, 3.0);
  std::rotate(expected.begin(), expected.begin() + 17, expected.end());
  EXPECT_LT(largest_distance(gaussian_smoothed(turned, true, 3.0), expected), 1e-12);
}

TEST(Smoothing, TooFewPointsStayAsTheyAre) {
  std::vector<Vec2> points{{0, 0}, {1, 5}, {2, 0}, {3, 5}};
  const std::vector<Vec2> before = points;
  EXPECT_EQ(smooth_keeping_bends(points, false, 2.0), 0.0);
  EXPECT_EQ(largest_distance(points, before), 0.0);
}

}  // namespace
}  // namespace telekerf::geometry
