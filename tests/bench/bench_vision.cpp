// SPDX-License-Identifier: Apache-2.0
// Picture to ordered points at 1920 x 1080 against OpenCV's own Gaussian + Canny + findContours on the same
// pictures in the same run, turn by turn; and the cost of a contour against its length. Medians of wall-clock
// times after a warm-up.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/vision/extract.h"
#include "slave/vision/drawing.h"

namespace {

using namespace telekerf;

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  std::vector<double> all;
  double at(double share) {
    std::sort(all.begin(), all.end());
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  }
};

std::size_t opencv_points(const cv::Mat& picture) {
  cv::Mat smooth;
  cv::Mat edges;
  std::vector<std::vector<cv::Point>> contours;
  cv::GaussianBlur(picture, smooth, {5, 5}, 1.0);
  cv::Canny(smooth, edges, 60, 140);
  cv::findContours(edges, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::size_t points = 0;
  for (const auto& contour : contours) points += contour.size();
  return points;
}

}  // namespace

int main() {
  constexpr int kWidth = 1920;
  constexpr int kHeight = 1080;
  constexpr int kRounds = 15;
  fmt::print("{:10} {:8} {:>8} {:>9} {:>9} {:>9} | {:>9} {:>9} | {:>6}\n", "drawing", "mode", "points",
             "median ms", "p90 ms", "max ms", "cv median", "cv p90", "ratio");
  double worst = 0.0;
  for (const char* name :
       {"circle", "heart", "figure-8", "spiral", "script-e", "gear", "letter-e", "flange", "blob"}) {
    drawing::Drawing drawing = *drawing::by_name(name, kWidth, kHeight);
    drawing.pen_px *= 2.0;
    std::vector<cv::Mat> pictures;
    for (int i = 0; i < 3; ++i) {
      drawing::Look look;
      look.width_px = kWidth;
      look.height_px = kHeight;
      look.noise = 4.0;
      look.seed = static_cast<std::uint64_t>(i + 1);
      pictures.push_back(drawing::render(drawing, look));
    }
    Times ours;
    Times theirs;
    std::string mode;
    std::size_t points = 0;
    for (int round = -2; round < kRounds; ++round) {
      const cv::Mat& picture = pictures[static_cast<std::size_t>(round + 3) % pictures.size()];
      const double ms = milliseconds([&] {
        const auto found = vision::extract(picture);
        if (!found) return;
        mode = vision::name_of(found->mode);
        points = found->contours.front().points_px.size();
      });
      const double peer = milliseconds([&] { (void)opencv_points(picture); });
      if (round < 0) continue;
      ours.all.push_back(ms);
      theirs.all.push_back(peer);
    }
    const double ratio = ours.at(0.5) / theirs.at(0.5);
    worst = std::max(worst, ratio);
    fmt::print("{:10} {:8} {:8} {:9.2f} {:9.2f} {:9.2f} | {:9.2f} {:9.2f} | {:6.2f}\n", name, mode, points,
               ours.at(0.5), ours.at(0.9), ours.at(1.0), theirs.at(0.5), theirs.at(0.9), ratio);
  }
  fmt::print("largest ratio {:.2f} (bar: 2)\n\n", worst);

  fmt::print("{:>8} {:>12} {:>14}\n", "points", "build us", "query ns");
  for (const std::size_t n : {1000U, 10000U, 100000U}) {
    geometry::Polyline line{{}, true};
    for (std::size_t i = 0; i < n; ++i) {
      const double a = 2.0 * M_PI * static_cast<double>(i) / static_cast<double>(n);
      line.points_m.emplace_back(0.02 * std::sin(a), 0.02 * std::sin(a) * std::cos(a));
    }
    Times build;
    Times query;
    for (int round = 0; round < 9; ++round) {
      build.all.push_back(1e3 * milliseconds([&] { geometry::NearestIndex index(line); }));
      const geometry::NearestIndex index(line);
      double sum = 0.0;
      query.all.push_back(
          1e6 / 20000 * milliseconds([&] {
            for (int i = 0; i < 20000; ++i) {
              sum += index.find({0.021 * std::sin(i * 0.7), 0.012 * std::cos(i * 1.3)}).distance_m;
            }
          }));
      if (sum < 0.0) return 1;
    }
    fmt::print("{:8} {:12.1f} {:14.1f}\n", n, build.at(0.5), query.at(0.5));
  }
  return 0;
}
