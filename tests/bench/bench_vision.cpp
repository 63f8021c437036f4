// SPDX-License-Identifier: Apache-2.0
// Picture to ordered points at 1920 x 1080 against OpenCV's own Gaussian + Canny + findContours on the same
// pictures in the same run, turn by turn, in three modes; and the cost of a contour against its length.
// Wall-clock times after a warm-up: the best says what it costs, the median what it costs on this machine as
// it is loaded.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/vision/extraction/contour_extraction.h"
#include "tools/draw-pictures/rendering.h"

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

drawing::Drawing spiral(int turns, int width, int height) {
  drawing::Drawing out{{{{}, false}}, false, 4.0};
  const int points = 600 * turns;
  for (int i = 0; i <= points; ++i) {
    const double t = static_cast<double>(i) / points;
    const double angle = 2.0 * M_PI * turns * t;
    const double radius = 20.0 + 490.0 * t;
    out.lines_px[0].points_m.emplace_back(0.5 * width + radius * std::cos(angle),
                                          0.5 * height + radius * std::sin(angle));
  }
  return out;
}

}  // namespace

int main() {
  constexpr int kWidth = 1920;
  constexpr int kHeight = 1080;
  constexpr int kRounds = 15;
  fmt::print("{:10} {:8} {:>8} {:>9} {:>9} {:>9} | {:>9} {:>9} | {:>7} {:>9}\n", "drawing", "mode", "points",
             "best ms", "median ms", "p90 ms", "cv best", "cv median", "of best", "of median");
  double worst_best = 0.0;
  double worst_median = 0.0;
  for (const char* name :
       {"circle", "heart", "figure-8", "spiral", "script-e", "gear", "letter-e", "flange", "blob"}) {
    drawing::Drawing drawing = *drawing::by_name(name, kWidth, kHeight);
    drawing.pen_px *= 2.0;
    std::vector<cv::Mat> pictures;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      drawing::Appearance appearance;
      appearance.width_px = kWidth;
      appearance.height_px = kHeight;
      appearance.noise = 4.0;
      appearance.seed = seed;
      pictures.push_back(drawing::render(drawing, appearance));
    }
    for (const vision::ExtractionMode mode :
         {vision::ExtractionMode::kAuto, vision::ExtractionMode::kOutline, vision::ExtractionMode::kStroke}) {
      Times ours;
      Times theirs;
      std::size_t points = 0;
      for (int round = -2; round < kRounds; ++round) {
        const cv::Mat& picture = pictures[static_cast<std::size_t>(round + 3) % pictures.size()];
        const double ms = milliseconds([&] {
          const auto found = vision::extract(picture, {.mode = mode});
          points = found ? found->contours.front().points_px.size() : 0;
        });
        const double peer = milliseconds([&] { (void)opencv_points(picture); });
        if (round < 0) continue;
        ours.all.push_back(ms);
        theirs.all.push_back(peer);
      }
      const double of_best = ours.at(0.0) / theirs.at(0.0);
      const double of_median = ours.at(0.5) / theirs.at(0.5);
      worst_best = std::max(worst_best, of_best);
      worst_median = std::max(worst_median, of_median);
      fmt::print("{:10} {:8} {:8} {:9.2f} {:9.2f} {:9.2f} | {:9.2f} {:9.2f} | {:7.2f} {:9.2f}\n", name,
                 vision::kExtractionModes.word(mode), points, ours.at(0.0), ours.at(0.5), ours.at(0.9),
                 theirs.at(0.0), theirs.at(0.5), of_best, of_median);
    }
  }
  fmt::print("largest ratio {:.2f} of the best times, {:.2f} of the medians (bar: 2)\n\n", worst_best,
             worst_median);

  // The same frame with more and more line in it: what a frame costs anyway, and what a point adds.
  fmt::print("{:>8} {:>8} {:>10} {:>22}\n", "turns", "points", "median ms", "us a point beyond 2 turns");
  double base_ms = 0.0;
  double base_points = 0.0;
  for (const int turns : {2, 4, 8, 16, 32}) {
    const cv::Mat picture = drawing::render(spiral(turns, kWidth, kHeight),
                                            {.width_px = kWidth, .height_px = kHeight, .noise = 4.0});
    Times times;
    std::size_t points = 0;
    for (int round = -2; round < kRounds; ++round) {
      const double ms = milliseconds([&] {
        const auto found = vision::extract(picture, {.mode = vision::ExtractionMode::kStroke});
        if (found) points = found->contours.front().points_px.size();
      });
      if (round >= 0) times.all.push_back(ms);
    }
    if (turns == 2) {
      base_ms = times.at(0.5);
      base_points = static_cast<double>(points);
    }
    const double more = static_cast<double>(points) - base_points;
    fmt::print("{:8} {:8} {:10.2f} {:>22}\n", turns, points, times.at(0.5),
               more > 0.0 ? fmt::format("{:.2f}", 1e3 * (times.at(0.5) - base_ms) / more) : "");
  }

  fmt::print("\n{:>8} {:>12} {:>14}\n", "points", "build us", "query ns");
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
