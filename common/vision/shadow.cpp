// SPDX-License-Identifier: Apache-2.0
#include "common/vision/shadow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace telekerf::vision {
namespace {

constexpr int kReach = 2;  ///< pixels to either side that a step is measured over

struct Edge {
  int step = 0;  ///< grey levels
  bool on_border = false;
};

/// The steepest places along one row or column: `smooth` and `drawn` with `count` pixels, `stride` bytes
/// apart.
void collect(const unsigned char* smooth, const unsigned char* drawn, int count, std::size_t stride,
             std::vector<Edge>& edges) {
  const auto step = [&](int i) {
    return std::abs(smooth[(i + kReach) * stride] - smooth[(i - kReach) * stride]);
  };
  for (int i = 2 * kReach; i + 2 * kReach < count; ++i) {
    const int here = step(i);
    if (here < 4 || here < step(i - 1) || here <= step(i + 1)) continue;
    bool on_border = false;
    for (int k = i - kReach - 1; k < i + kReach + 1; ++k)
      on_border = on_border || drawn[k * stride] != drawn[(k + 1) * stride];
    edges.push_back({here, on_border});
  }
}

}  // namespace

double explained_edges(const Field& field) {
  constexpr int kLines = 100;
  constexpr std::size_t kSteepest = 40;  // at least as many places cross a drawing that stands out
  constexpr double kSharp = 0.5;         // share of their steps
  std::vector<Edge> edges;
  const cv::Mat& smooth = field.smooth;
  const cv::Mat& drawn = field.drawn;
  for (int y = 0; y < smooth.rows; y += smooth.rows / kLines + 1)
    collect(smooth.ptr(y), drawn.ptr(y), smooth.cols, 1, edges);
  for (int x = 0; x < smooth.cols; x += smooth.cols / kLines + 1)
    collect(smooth.ptr(0) + x, drawn.ptr(0) + x, smooth.rows, smooth.step[0], edges);
  const double noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  std::erase_if(edges, [&](const Edge& e) { return e.step < 8.0 * noise; });
  if (edges.size() < 8) return 1.0;
  const auto steep = edges.begin() + static_cast<std::ptrdiff_t>(std::min(kSteepest, edges.size() / 4));
  std::nth_element(edges.begin(), steep, edges.end(),
                   [](const Edge& a, const Edge& b) { return a.step > b.step; });
  const double sharp = kSharp * steep->step;
  int all = 0;
  int explained = 0;
  for (const Edge& e : edges) {
    if (e.step < sharp) continue;
    ++all;
    explained += e.on_border;
  }
  return static_cast<double>(explained) / all;
}

Field at_explaining_level(const Field& field) {
  constexpr int kFirst = 12;
  constexpr int kStep = 8;
  Field best = field;
  best.drawn = field.drawn.clone();  // a copied field shares its planes
  double most = explained_edges(field);
  for (int level = kFirst; level < 256 - kFirst; level += kStep) {
    Field other = field;
    other.level = level + 0.5;
    cv::Mat drawn;
    cv::threshold(field.smooth, drawn, level, 255, field.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
    other.drawn = drawn;
    const double explained = explained_edges(other);
    if (explained <= most) continue;
    most = explained;
    best = other;
  }
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
    cv::subtract(paper, grey, out);
    cv::subtract(cv::Scalar(230), out, out);
  } else {
    cv::subtract(grey, paper, out);
    cv::add(out, cv::Scalar(25), out);
  }
  return out;
}

}  // namespace telekerf::vision
