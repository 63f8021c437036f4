// SPDX-License-Identifier: Apache-2.0
#include "common/vision/shadow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace telekerf::vision {
namespace {

constexpr int kReach = 2;  ///< pixels to either side that a step is measured over

/// A place where the picture is steep: a border lies on it if its level is between `low` and `high`.
struct Edge {
  int step = 0;  ///< grey levels
  int low = 0;
  int high = 0;
};

/// The steepest places along one row or column of `count` pixels, `stride` bytes apart.
void collect(const unsigned char* smooth, int count, std::size_t stride, std::vector<Edge>& edges) {
  const auto step = [&](int i) {
    return std::abs(smooth[(i + kReach) * stride] - smooth[(i - kReach) * stride]);
  };
  for (int i = 2 * kReach; i + 2 * kReach < count; ++i) {
    const int here = step(i);
    if (here < 4 || here < step(i - 1) || here <= step(i + 1)) continue;
    Edge edge{here, 255, 0};
    for (int k = i - kReach - 1; k <= i + kReach + 1; ++k) {
      edge.low = std::min<int>(edge.low, smooth[k * stride]);
      edge.high = std::max<int>(edge.high, smooth[k * stride]);
    }
    edges.push_back(edge);
  }
}

/// The sharp edges of some rows and columns; none if there are too few to say anything.
std::vector<Edge> sharp_edges(const Field& field) {
  constexpr int kLines = 100;
  constexpr std::size_t kFewest = 8;
  constexpr std::size_t kSteepest = 40;  // at least as many places cross a drawing that stands out
  constexpr double kSharp = 0.5;         // share of their steps
  std::vector<Edge> edges;
  const cv::Mat& smooth = field.smooth;
  for (int y = 0; y < smooth.rows; y += smooth.rows / kLines + 1)
    collect(smooth.ptr(y), smooth.cols, 1, edges);
  for (int x = 0; x < smooth.cols; x += smooth.cols / kLines + 1)
    collect(smooth.ptr(0) + x, smooth.rows, smooth.step[0], edges);
  const double noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  std::erase_if(edges, [&](const Edge& e) { return e.step < 8.0 * noise; });
  if (edges.size() < kFewest) return {};
  const auto steep = edges.begin() + static_cast<std::ptrdiff_t>(std::min(kSteepest, edges.size() / 4));
  std::nth_element(edges.begin(), steep, edges.end(),
                   [](const Edge& a, const Edge& b) { return a.step > b.step; });
  const double sharp = kSharp * steep->step;
  std::erase_if(edges, [&](const Edge& e) { return e.step < sharp; });
  return edges;
}

double explained_at(const std::vector<Edge>& edges, double level) {
  if (edges.empty()) return 1.0;
  const auto on_border = std::count_if(edges.begin(), edges.end(),
                                       [&](const Edge& e) { return e.low < level && level < e.high; });
  return static_cast<double>(on_border) / static_cast<double>(edges.size());
}

}  // namespace

double explained_edges(const Field& field) { return explained_at(sharp_edges(field), field.level); }

Field at_explaining_level(const Field& field) {
  const std::vector<Edge> edges = sharp_edges(field);
  Field best = field;
  double most = explained_at(edges, field.level);
  for (int level = 8; level < 248; ++level) {
    const double explained = explained_at(edges, level + 0.5);
    if (explained <= most) continue;
    most = explained;
    best.level = level + 0.5;
  }
  // Of all levels as good one that keeps off the background, where specks begin.
  if (best.level != field.level) {
    double last = best.level;
    while (last < 248.0 && explained_at(edges, last + 1.0) >= most) last += 1.0;
    best.dark = !border_is_dark(best.smooth, 0.5 * (best.level + last));
    best.level = std::floor(best.level + (best.dark ? 1.0 : 2.0) / 3.0 * (last - best.level)) + 0.5;
  }
  // A copied field shares its planes.
  best.drawn = cv::Mat();
  cv::threshold(best.smooth, best.drawn, std::floor(best.level), 255,
                best.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
  if (best.level != field.level) {
    cv::Mat background;
    cv::bitwise_not(best.drawn, background);
    best.contrast = std::abs(cv::mean(best.smooth, best.drawn)[0] - cv::mean(best.smooth, background)[0]);
  }
  return best;
}

cv::Mat without_shadows(const cv::Mat& grey, int small_side) {
  // The paper alone, in small: lines are filled up from their sides. Dark ones by a closing, light ones by an
  // opening; the one that takes more away has found the drawing.
  constexpr int kWidestLine = 15;
  const double scale = std::min(1.0, double(small_side) / std::min(grey.cols, grey.rows));
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kWidestLine, kWidestLine});
  cv::Mat closed;
  cv::Mat opened;
  cv::morphologyEx(small, closed, cv::MORPH_CLOSE, kernel);
  cv::morphologyEx(small, opened, cv::MORPH_OPEN, kernel);
  const bool dark = cv::norm(closed, small, cv::NORM_L2) >= cv::norm(small, opened, cv::NORM_L2);
  cv::Mat paper;
  cv::GaussianBlur(dark ? closed : opened, paper, {}, 2.0);
  cv::resize(paper, paper, grey.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out;
  if (dark) {
    cv::divide(grey, paper, out, 230.0);  // ink takes its share of whatever light there is
  } else {
    cv::subtract(grey, paper, out);
    cv::add(out, cv::Scalar(25), out);
  }
  return out;
}

}  // namespace telekerf::vision
