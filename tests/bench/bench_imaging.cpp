// SPDX-License-Identifier: Apache-2.0
// The normalised variance of a region of 1280 x 960 pixels, tile by tile, against cv::meanStdDev of the same
// region in the same run, turn by turn, each on one thread; and Tenengrad beside them. Wall-clock times after
// a warm-up: the best says what it costs, the median what it costs on this machine as it is loaded.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "slave/vision/imaging/sharpness.h"

namespace {

using namespace telekerf;

double microseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  std::vector<double> all;
  double at(double share) {
    std::sort(all.begin(), all.end());
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  }
};

}  // namespace

int main() {
  constexpr int kRounds = 400;
  cv::setNumThreads(1);
  std::vector<cv::Mat> pictures;  // regions of a larger picture, as a camera's are
  for (int i = 0; i < 4; ++i) {
    cv::Mat picture(1080, 1440, CV_8U);
    cv::RNG random(static_cast<std::uint64_t>(i + 1));
    random.fill(picture, cv::RNG::UNIFORM, 0, 256);
    pictures.push_back(picture(cv::Rect(80, 60, 1280, 960)));
  }
  Times ours;
  Times theirs;
  Times tenengrad;
  double sink = 0.0;
  for (int round = -20; round < kRounds; ++round) {
    const cv::Mat& region = pictures[static_cast<std::size_t>(round + 20) / 2 % pictures.size()];
    double us = 0.0;
    double peer = 0.0;
    // Whoever comes second finds the pixels in the cache: each comes first as often as the other.
    for (int turn = 0; turn < 2; ++turn) {
      if ((turn + round) % 2 == 0) {
        us = microseconds([&] { sink += imaging::sharpness_of(region, {}, false).variance; });
        continue;
      }
      peer = microseconds([&] {
        cv::Scalar mean;
        cv::Scalar deviation;
        cv::meanStdDev(region, mean, deviation);
        sink += deviation[0] * deviation[0] / mean[0];
      });
    }
    if (round < 0) continue;
    ours.all.push_back(us);
    theirs.all.push_back(peer);
    if (round % 20 == 0)
      tenengrad.all.push_back(microseconds([&] { sink += imaging::sharpness_of(region, {}).tenengrad; }));
  }
  fmt::print("{:24} {:>9} {:>9} {:>9}\n", "1280 x 960, us", "best", "median", "p90");
  const auto row = [](const char* name, Times& times) {
    fmt::print("{:24} {:9.1f} {:9.1f} {:9.1f}\n", name, times.at(0.0), times.at(0.5), times.at(0.9));
  };
  row("normalised variance", ours);
  row("cv::meanStdDev", theirs);
  row("... and Tenengrad", tenengrad);
  fmt::print("speed over cv::meanStdDev: {:.2f} of the best times, {:.2f} of the medians (bar: 1)\n",
             theirs.at(0.0) / ours.at(0.0), theirs.at(0.5) / ours.at(0.5));
  return sink > 0.0 && theirs.at(0.0) >= ours.at(0.0) ? 0 : 1;
}
