// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/edge_evidence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/vision/raster/light.h"

namespace telekerf::vision {
namespace {

constexpr int kReach = 2;  ///< pixels to either side that a step is measured over
constexpr int kFar = 8;    ///< and within which it is over

/// A place where the picture is steep: a border lies on it if its level is between `low` and `high`.
struct Edge {
  int step = 0;  ///< grey levels
  int low = 0;
  int high = 0;
  int lowest = 0;  ///< further off to both sides
  int highest = 0;
};

/// The steepest places along one line of `count` pixels, of `min_step` grey levels or more.
void collect(const unsigned char* line, int count, int min_step, std::vector<Edge>& edges) {
  const auto step = [&](int i) { return std::abs(line[i + kReach] - line[i - kReach]); };
  for (int i = 2 * kReach; i + 2 * kReach < count; ++i) {
    const int here = step(i);
    if (here < min_step || here < step(i - 1) || here <= step(i + 1)) continue;
    const auto [low, high] = std::minmax_element(line + i - kReach - 1, line + i + kReach + 2);
    const auto [lowest, highest] =
        std::minmax_element(line + std::max(0, i - kFar), line + std::min(count, i + kFar + 1));
    edges.push_back({here, *low, *high, *lowest, *highest});
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

/// The edges of some rows and columns; none if there are too few to say anything.
std::vector<Edge> edges_of(const Field& field) {
  constexpr int kLines = 40;
  constexpr std::size_t kMinEdges = 8;
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
  return edges;
}

/// Those that are half as steep as the steepest.
std::vector<Edge> sharp_ones(std::vector<Edge> edges) {
  constexpr std::size_t kSteepest = 40;  // at least as many places cross a drawing that stands out
  constexpr double kSharp = 0.5;         // fraction of their steps
  if (edges.empty()) return edges;
  const auto steep = edges.begin() + static_cast<std::ptrdiff_t>(std::min(kSteepest, edges.size() / 4));
  std::nth_element(edges.begin(), steep, edges.end(),
                   [](const Edge& a, const Edge& b) { return a.step > b.step; });
  const double sharp = kSharp * steep->step;
  std::erase_if(edges, [&](const Edge& e) { return e.step < sharp; });
  return edges;
}

/// Grey levels as they are in a dark drawing on a light background.
Edge as_if_dark(const Edge& e, bool dark) {
  if (dark) return e;
  return {e.step, 255 - e.high, 255 - e.low, 255 - e.highest, 255 - e.lowest};
}

/// What the picture's border shows beside what is drawn, as in a dark drawing.
struct Background {
  double grey = 0.0;   ///< of most of it
  double range = 0.0;  ///< of four fifths
};

std::optional<Background> background_of(const Field& field) {
  std::vector<int> greys;
  const auto look = [&](int x, int y) {
    const int grey = field.smooth.at<unsigned char>(y, x);
    if ((grey > field.level) == field.dark) greys.push_back(field.dark ? grey : 255 - grey);
  };
  for (int x = 0; x < field.smooth.cols; x += 2) {
    look(x, 0);
    look(x, field.smooth.rows - 1);
  }
  for (int y = 0; y < field.smooth.rows; y += 2) {
    look(0, y);
    look(field.smooth.cols - 1, y);
  }
  if (greys.empty()) return std::nullopt;
  std::sort(greys.begin(), greys.end());
  const std::size_t last = greys.size() - 1;
  return Background{double(greys[last / 2]), double(greys[last * 9 / 10] - greys[last / 10])};
}

/// What lies off the background and is not drawn.
struct Beside {
  std::vector<Edge> fainter;
  std::size_t opposite = 0;
  std::size_t drawn = 0;  ///< edges of the drawing
};

Beside beside(const Field& field, const std::vector<Edge>& edges) {
  constexpr double kLeast = 0.08;      // of the drawing's contrast
  constexpr double kAllTheWay = 0.65;  // of a step: within the edge, the rest beyond
  constexpr double kEven = 0.3;
  Beside out;
  const double level = field.dark ? field.level : 255.0 - field.level;
  for (const Edge& e : edges) out.drawn += e.low < field.level && field.level < e.high;
  const auto background = background_of(field);
  if (out.drawn == 0 || !background) return out;
  const double contrast = 2.0 * (background->grey - level);
  // From one even grey all the way to another: no shadow's soft end.
  const auto is_clear = [&](const Edge& e) {
    const double step = e.high - e.low;
    return step > kLeast * contrast && step > kAllTheWay * (e.highest - e.lowest);
  };
  for (const Edge& as_is : edges) {
    const Edge e = as_if_dark(as_is, field.dark);
    if (e.low <= level || !is_clear(e)) continue;
    const double above = e.high - background->grey;
    if (above > (1.0 - kEven) * (e.high - e.low)) {
      ++out.opposite;
    } else if (above > -0.25 * contrast) {
      out.fainter.push_back(e);
    }
  }
  return out;
}

double explained_at(const std::vector<Edge>& edges, double level) {
  if (edges.empty()) return 1.0;
  const auto on_border = std::count_if(edges.begin(), edges.end(),
                                       [&](const Edge& e) { return e.low < level && level < e.high; });
  return static_cast<double>(on_border) / static_cast<double>(edges.size());
}

}  // namespace

EdgeEvidence edge_evidence(const Field& field) {
  std::vector<Edge> edges = edges_of(field);
  EdgeEvidence out;
  const Beside others = beside(field, edges);
  const double drawn = std::max<double>(1.0, static_cast<double>(others.drawn));
  out.fainter = static_cast<double>(others.fainter.size()) / drawn;
  out.opposite = static_cast<double>(others.opposite) / drawn;
  out.explained = explained_at(sharp_ones(std::move(edges)), field.level);
  return out;
}

double explained_by_either(const Field& field, double other_level) {
  const std::vector<Edge> edges = sharp_ones(edges_of(field));
  if (edges.empty()) return 1.0;
  const auto within = [](const Edge& e, double level) { return e.low < level && level < e.high; };
  const auto known = std::count_if(edges.begin(), edges.end(), [&](const Edge& e) {
    return within(e, field.level) || within(e, other_level);
  });
  return static_cast<double>(known) / static_cast<double>(edges.size());
}

Field at_explaining_level(const Field& field) {
  const std::vector<Edge> edges = sharp_ones(edges_of(field));
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

FainterSplit at_fainter_level(const Field& field) {
  FainterSplit split{field, 0.0};
  Field& out = split.field;
  // A large pale shape looks like a change of light; on the border only light changes.
  constexpr double kUneven = 8.0;
  if (const auto background = background_of(field); background && background->range > kUneven) {
    if (const auto light = light_of(field.smooth, field.noise)) out.smooth = flattened(field.smooth, *light);
  }
  const std::vector<Edge> fainter = beside(out, edges_of(out)).fainter;
  if (fainter.empty()) return split;
  // The middle of the levels that cross most of these edges; they are as those of a dark drawing.
  int first = 1;
  for (int level = 1; level < 255; ++level) {
    if (explained_at(fainter, level + 0.5) > explained_at(fainter, first + 0.5)) first = level;
  }
  int last = first;
  while (last < 254 && explained_at(fainter, last + 1.5) >= explained_at(fainter, first + 0.5)) ++last;
  const double level = std::floor(0.5 * (first + last)) + 0.5;
  std::vector<int> steps;
  for (const Edge& e : fainter) steps.push_back(e.high - e.low);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  out.contrast = steps[steps.size() / 2];
  if (const auto background = background_of(field)) split.faintest = 2.0 * (background->grey - level);
  out.level = field.dark ? level : 255.0 - level;
  out.drawn = cv::Mat();  // a copied field shares its planes
  cv::threshold(out.smooth, out.drawn, std::floor(out.level), 255,
                out.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
  return split;
}

}  // namespace telekerf::vision
