// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/grid_view.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

namespace telekerf::imaging {
namespace {

constexpr int kFewestDots = 25;
constexpr double kMostResidual_px = 0.5;
/// A neighbour is looked for this near to its place, as a share of the pitch.
constexpr double kNearby = 0.3;
/// What is brighter than this share of the paper is paper.
constexpr double kPaperShare = 0.75;

using Lattice = std::map<std::pair<int, int>, cv::Point2d>;  ///< by column and row

/// The dots by their places, and the step from one to the next on its right.
struct Grid {
  Lattice lattice;
  cv::Point2d step;
};

std::optional<cv::Point2d> nearest(const std::vector<cv::Point2d>& dots, const cv::Point2d& to,
                                   double within) {
  std::optional<cv::Point2d> found;
  for (const cv::Point2d& dot : dots) {
    const double distance = cv::norm(dot - to);
    if (distance < within) {
      found = dot;
      within = distance;
    }
  }
  return found;
}

/// Gives each dot its row and column, from the middle outwards: a neighbour is where the last step leads
/// again.
Grid grid_of(const std::vector<cv::Point2d>& dots, const cv::Size& size) {
  const cv::Point2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  const auto first = nearest(dots, middle, std::numeric_limits<double>::max());
  if (!first) return {};
  cv::Point2d step;
  double shortest = std::numeric_limits<double>::max();
  for (const cv::Point2d& dot : dots) {
    const cv::Point2d way = dot - *first;
    // Towards the right and within an eighth of a turn: the lattice's own x.
    if (way.x <= std::abs(way.y) || cv::norm(way) >= shortest) continue;
    shortest = cv::norm(way);
    step = way;
  }
  if (shortest == std::numeric_limits<double>::max()) return {};
  struct Place {
    int column, row;
    cv::Point2d right, down;
  };
  Lattice lattice{{{0, 0}, *first}};
  std::deque<Place> open{{0, 0, step, {-step.y, step.x}}};
  while (!open.empty()) {
    const Place here = open.front();
    open.pop_front();
    const cv::Point2d from = lattice.at({here.column, here.row});
    for (const auto& [column, row] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const std::pair<int, int> index(here.column + column, here.row + row);
      if (lattice.count(index) > 0) continue;
      const cv::Point2d way = column * here.right + row * here.down;
      const auto dot = nearest(dots, from + way, kNearby * shortest);
      if (!dot) continue;
      lattice[index] = *dot;
      Place next{index.first, index.second, here.right, here.down};
      (column != 0 ? next.right : next.down) = (column + row) * (*dot - from);
      open.push_back(next);
    }
  }
  return {lattice, step};
}

/// Place of the lattice's origin, its step to the right, and the distortion.
using Parameters = Eigen::Matrix<double, 5, 1>;

Eigen::Vector2d seen_at(const Parameters& p, double column, double row, const cv::Size& size) {
  const Eigen::Vector2d straight(p[0] + p[2] * column - p[3] * row, p[1] + p[3] * column + p[2] * row);
  const double half = 0.5 * size.width;
  return (1.0 + p[4] * straight.squaredNorm() / (half * half)) * straight;  // from the picture's middle
}

/// Gauss-Newton; returns the rms of the residuals, pixels.
double fit(const Lattice& lattice, const cv::Size& size, Parameters& p) {
  const Eigen::Vector2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  const auto rows = static_cast<Eigen::Index>(2 * lattice.size());
  Eigen::VectorXd residual(rows);
  Eigen::MatrixXd slopes(rows, 5);
  const Parameters steps = (Parameters() << 1e-3, 1e-3, 1e-5, 1e-5, 1e-6).finished();
  for (int round = 0; round < 6; ++round) {
    Eigen::Index row = 0;
    for (const auto& [index, dot] : lattice) {
      const Eigen::Vector2d here = seen_at(p, index.first, index.second, size);
      residual.segment<2>(row) = Eigen::Vector2d(dot.x, dot.y) - middle - here;
      for (int k = 0; k < 5; ++k) {
        Parameters q = p;
        q[k] += steps[k];
        slopes.block<2, 1>(row, k) = (seen_at(q, index.first, index.second, size) - here) / steps[k];
      }
      row += 2;
    }
    p += slopes.colPivHouseholderQr().solve(residual);
  }
  return std::sqrt(residual.squaredNorm() / static_cast<double>(lattice.size()));
}

/// Without the dots that dust has pushed aside: those farther off than three times the median.
Lattice without_outliers(const Lattice& lattice, const cv::Size& size, const Parameters& p) {
  const cv::Point2d middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  std::vector<double> off;
  for (const auto& [index, dot] : lattice) {
    const Eigen::Vector2d expected = seen_at(p, index.first, index.second, size);
    off.push_back(cv::norm(dot - middle - cv::Point2d(expected.x(), expected.y())));
  }
  std::vector<double> sorted = off;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double most = 3.0 * sorted[sorted.size() / 2];
  Lattice kept;
  std::size_t i = 0;
  for (const auto& entry : lattice) {
    if (off[i++] <= most) kept.insert(entry);
  }
  return kept;
}

/// The light on the paper between the dots, by least squares over all of its pixels.
std::array<double, 4> light_on(const cv::Mat& grey, const cv::Mat& paper) {
  const double half = 0.5 * grey.cols;
  std::vector<cv::Point> places;
  cv::findNonZero(paper, places);
  Parameters light = Parameters::Zero();
  Eigen::Matrix<double, 5, 5> squares = Eigen::Matrix<double, 5, 5>::Zero();
  for (const cv::Point& place : places) {
    const double x = (place.x - 0.5 * (grey.cols - 1)) / half;
    const double y = (place.y - 0.5 * (grey.rows - 1)) / half;
    const double r2 = x * x + y * y;
    const Parameters terms(1.0, x, y, r2, r2 * r2);
    squares += terms * terms.transpose();
    light += grey.at<std::uint8_t>(place) * terms;
  }
  const Parameters c = squares.ldlt().solve(light);
  return {c[1] / c[0], c[2] / c[0], c[3] / c[0], c[4] / c[0]};
}

/// Dark against what lies around, whatever the light: the dots.
cv::Mat dark_places(const cv::Mat& grey) {
  cv::Mat dark;
  const int around = std::max(31, grey.cols / 8 | 1);
  cv::adaptiveThreshold(grey, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, around, 20.0);
  return dark;
}

}  // namespace

std::vector<cv::Point2d> dots_in(const cv::Mat& grey) {
  cv::Mat labels;
  cv::Mat boxes;
  cv::Mat middles;
  const int count = cv::connectedComponentsWithStats(dark_places(grey), labels, boxes, middles, 8, CV_32S);
  std::vector<cv::Point2d> dots;
  for (int i = 1; i < count; ++i) {
    const cv::Rect box(boxes.at<int>(i, cv::CC_STAT_LEFT) - 2, boxes.at<int>(i, cv::CC_STAT_TOP) - 2,
                       boxes.at<int>(i, cv::CC_STAT_WIDTH) + 4, boxes.at<int>(i, cv::CC_STAT_HEIGHT) + 4);
    const bool inside =
        box.x >= 0 && box.y >= 0 && box.x + box.width <= grey.cols && box.y + box.height <= grey.rows;
    const int area = boxes.at<int>(i, cv::CC_STAT_AREA);
    const bool round = std::abs(box.width - box.height) <= 0.25 * box.width + 1 && area > 12;
    if (!inside || !round) continue;
    // Weighed by how dark a pixel is against the paper at the box's edge: finer than the threshold.
    const cv::Mat part = grey(box);
    double paper = 0.0;
    cv::minMaxLoc(part, nullptr, &paper);
    cv::Mat darkness = paper - part;
    darkness.setTo(0, part > kPaperShare * paper);
    const cv::Moments moments = cv::moments(darkness);
    if (moments.m00 > 0.0)
      dots.emplace_back(box.x + moments.m10 / moments.m00, box.y + moments.m01 / moments.m00);
  }
  return dots;
}

tl::expected<GridView, std::string> measure_grid(const cv::Mat& grey, double pitch_m) {
  const std::vector<cv::Point2d> dots = dots_in(grey);
  const auto [lattice, step] = grid_of(dots, grey.size());
  if (lattice.size() < kFewestDots) {
    return tl::unexpected(fmt::format("no printed grid is seen: {} dots in a lattice, at least {} are needed",
                                      lattice.size(), kFewestDots));
  }
  Parameters p(0.0, 0.0, step.x, step.y, 0.0);  // the lattice begins near the middle
  GridView view;
  fit(lattice, grey.size(), p);
  const Lattice kept = without_outliers(lattice, grey.size(), p);
  view.residual_px = fit(kept, grey.size(), p);
  if (!(view.residual_px < kMostResidual_px))
    return tl::unexpected(
        fmt::format("the dots are {:.2f} pixels off a square lattice, at most {} are allowed",
                    view.residual_px, kMostResidual_px));
  view.metres_per_pixel = pitch_m / std::hypot(p[2], p[3]);
  view.distortion = p[4];
  view.dots = static_cast<int>(kept.size());
  cv::Mat paper;
  cv::dilate(dark_places(grey), paper, cv::Mat(), {-1, -1}, 3);
  view.flat_field = light_on(grey, paper == 0);
  return view;
}

}  // namespace telekerf::imaging
