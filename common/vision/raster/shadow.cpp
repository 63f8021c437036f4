// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/shadow.h"

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

/// The steepest places along one line of `count` pixels, of `min_step` grey levels or more.
void collect(const unsigned char* line, int count, int min_step, std::vector<Edge>& edges) {
  const auto step = [&](int i) { return std::abs(line[i + kReach] - line[i - kReach]); };
  for (int i = 2 * kReach; i + 2 * kReach < count; ++i) {
    const int here = step(i);
    if (here < min_step || here < step(i - 1) || here <= step(i + 1)) continue;
    const auto [low, high] = std::minmax_element(line + i - kReach - 1, line + i + kReach + 2);
    edges.push_back({here, *low, *high});
  }
}

/// Every `every`-th column of a picture, as rows.
cv::Mat columns_of(const cv::Mat& picture, int every) {
  cv::Mat out(picture.cols / every, picture.rows, CV_8U);
  for (int y = 0; y < picture.rows; ++y) {  // row by row, as it lies in memory
    const auto* row = picture.ptr<unsigned char>(y);
    for (int k = 0; k < out.rows; ++k) out.at<unsigned char>(k, y) = row[k * every];
  }
  return out;
}

/// The sharp edges of some rows and columns; none if there are too few to say anything.
std::vector<Edge> sharp_edges(const Field& field) {
  constexpr int kLines = 40;
  constexpr std::size_t kMinEdges = 8;
  constexpr std::size_t kSteepest = 40;  // at least as many places cross a drawing that stands out
  constexpr double kSharp = 0.5;         // fraction of their steps
  std::vector<Edge> edges;
  const cv::Mat& smooth = field.smooth;
  const double noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  const int min_step = std::max(4, static_cast<int>(std::ceil(8.0 * noise)));
  for (int y = 0; y < smooth.rows; y += smooth.rows / kLines + 1)
    collect(smooth.ptr<unsigned char>(y), smooth.cols, min_step, edges);
  const cv::Mat columns = columns_of(smooth, smooth.cols / kLines + 1);
  for (int k = 0; k < columns.rows; ++k)
    collect(columns.ptr<unsigned char>(k), columns.cols, min_step, edges);
  if (edges.size() < kMinEdges) return {};
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
  double best_explained = explained_at(edges, field.level);
  for (int level = 8; level < 248; ++level) {
    const double explained = explained_at(edges, level + 0.5);
    if (explained <= best_explained) continue;
    best_explained = explained;
    best.level = level + 0.5;
  }
  // Of all levels as good one that keeps off the background, where specks begin.
  if (best.level != field.level) {
    double last = best.level;
    while (last < 248.0 && explained_at(edges, last + 1.0) >= best_explained) last += 1.0;
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
