// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/reporting/picture_file.h"

namespace telekerf::reporting {
namespace {

constexpr int kLeft = 70, kRight = 16, kTop = 34, kBottom = 46, kTitle = 34;
constexpr double kFont = 0.42;
const cv::Scalar kInk(40, 40, 40), kGrid(228, 228, 228), kPaper(255, 255, 255);
// Distinct to colour-blind readers as well (Okabe and Ito), as blue, green, red.
const std::array<cv::Scalar, 8> kPalette{
    cv::Scalar(178, 114, 0), cv::Scalar(0, 94, 213),   cv::Scalar(115, 158, 0),  cv::Scalar(167, 121, 204),
    cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86), cv::Scalar(66, 228, 240), cv::Scalar(60, 60, 60)};

/// One axis: values (or their logarithms) to pixels.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  int from_px = 0, to_px = 1;

  double mapped(double v) const { return logarithmic ? std::log10(v) : v; }
  double pixel(double v) const { return from_px + (mapped(v) - low) / (high - low) * (to_px - from_px); }
};

double nice_step(double span, int ticks) {
  const double raw = span / ticks;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10 * power;
}

struct Tick {
  double value;
  std::string label;
};

std::vector<Tick> ticks_of(const Axis& axis, int wanted) {
  std::vector<Tick> ticks;
  const double step = axis.logarithmic ? std::max(1.0, std::round((axis.high - axis.low) / wanted))
                                       : nice_step(axis.high - axis.low, wanted);
  const int decimals =
      axis.logarithmic ? 0 : std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  for (double k = std::ceil(axis.low / step - 1e-9); k * step <= axis.high + 1e-9 * step; ++k) {
    const double v = k * step + 0.0;
    if (axis.logarithmic) {
      ticks.push_back({std::pow(10, v), fmt::format("{:g}", std::pow(10, v))});
    } else {
      const bool wide = largest >= 1e5 || decimals > 4;
      ticks.push_back({v, wide ? fmt::format("{:.1e}", v) : fmt::format("{:.{}f}", v, decimals)});
    }
  }
  return ticks;
}

void expand(const Axis& axis, double v, double& low, double& high) {
  if (!std::isfinite(v) || (axis.logarithmic && v <= 0)) return;
  low = std::min(low, axis.mapped(v));
  high = std::max(high, axis.mapped(v));
}

void set_range(Axis& axis, const std::vector<Line>& lines, const std::optional<std::array<double, 2>>& asked,
               std::vector<double> Line::*values, double margin) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& line : lines) {
    for (const double v : line.*values) expand(axis, v, low, high);
  }
  if (!(low <= high)) low = 0, high = 1;
  if (high - low < 1e-12 * std::max(1.0, std::abs(high))) low -= 0.5, high += 0.5;
  const double room = margin * (high - low);
  axis.low = asked ? axis.mapped((*asked)[0]) : low - room;
  axis.high = asked ? axis.mapped((*asked)[1]) : high + room;
}

void text(cv::Mat& picture, const std::string& words, cv::Point at, double scale = kFont,
          const cv::Scalar& colour = kInk) {
  cv::putText(picture, words, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

cv::Size size_of(const std::string& words, double scale = kFont) {
  int base = 0;
  return cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &base);
}

void vertical_text(cv::Mat& picture, const std::string& words, cv::Point middle) {
  if (words.empty()) return;
  const cv::Size size = size_of(words);
  cv::Mat flat(size.height + 8, size.width + 2, CV_8UC3, kPaper);
  text(flat, words, {1, size.height + 2});
  cv::Mat upright;
  cv::rotate(flat, upright, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect at(middle.x - upright.cols / 2, middle.y - upright.rows / 2, upright.cols, upright.rows);
  const cv::Rect visible = at & cv::Rect(0, 0, picture.cols, picture.rows);
  upright(cv::Rect(visible.x - at.x, visible.y - at.y, visible.width, visible.height))
      .copyTo(picture(visible));
}

cv::Scalar colour_of(const Line& line, std::size_t place) {
  return kPalette[(line.colour >= 0 ? static_cast<std::size_t>(line.colour) : place) % kPalette.size()];
}

/// A polyline or, if dashed, its dashes: on and off by length along the line, in pixels.
void stroke(cv::Mat& area, const std::vector<cv::Point2d>& points, const Line& line,
            const cv::Scalar& colour) {
  constexpr int kShift = 4;  // sub-pixel bits of OpenCV's drawing
  const auto fixed = [](const cv::Point2d& p) {
    return cv::Point(cvRound(std::clamp(p.x, -1e5, 1e5) * (1 << kShift)),
                     cvRound(std::clamp(p.y, -1e5, 1e5) * (1 << kShift)));
  };
  if (line.style == Line::Style::kPoints) {
    for (const auto& p : points)
      cv::circle(area, fixed(p), 3 << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
    return;
  }
  constexpr double kDash = 7, kGap = 6;
  double along = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const cv::Point2d step = points[i] - points[i - 1];
    const double length = std::min(cv::norm(step), 1e4);
    if (line.style == Line::Style::kSolid) {
      cv::line(area, fixed(points[i - 1]), fixed(points[i]), colour, 2, cv::LINE_AA, kShift);
      continue;
    }
    for (double done = 0; done < length;) {
      const double phase = std::fmod(along, kDash + kGap);
      const double left = (phase < kDash ? kDash : kDash + kGap) - phase;
      const double part = std::min(left + 1e-9, length - done);
      if (phase < kDash) {
        cv::line(area, fixed(points[i - 1] + step * (done / length)),
                 fixed(points[i - 1] + step * ((done + part) / length)), colour, 2, cv::LINE_AA, kShift);
      }
      done += part;
      along += part;
    }
  }
}

void draw_lines(cv::Mat& area, const Panel& panel, const Axis& x, const Axis& y) {
  for (std::size_t n = 0; n < panel.lines.size(); ++n) {
    const Line& line = panel.lines[n];
    std::vector<cv::Point2d> run;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
      const cv::Point2d p(x.pixel(line.x[i]), y.pixel(line.y[i]));
      if (std::isfinite(p.x) && std::isfinite(p.y)) {
        run.push_back(p);
        continue;
      }
      stroke(area, run, line, colour_of(line, n));
      run.clear();
    }
    stroke(area, run, line, colour_of(line, n));
  }
}

constexpr int kRow = 17, kSample = 24;  // of a legend

/// Size of the legend, empty without labels.
cv::Size legend_size(const Panel& panel) {
  int width = 0, rows = 0;
  for (const auto& line : panel.lines) {
    if (line.label.empty()) continue;
    width = std::max(width, size_of(line.label).width);
    ++rows;
  }
  return rows == 0 ? cv::Size() : cv::Size(width + kSample + 18, rows * kRow + 8);
}

/// A legend this high would always cover something: it stands beside the panel.
bool legend_stands_beside(const cv::Size& legend) { return legend.height > 8 * kRow; }

/// The corner where the fewest drawn pixels would be covered.
cv::Rect emptiest_corner(const cv::Mat& area, const cv::Size& size) {
  cv::Mat drawn;
  cv::inRange(area, cv::Scalar(0, 0, 0), cv::Scalar(220, 220, 220), drawn);
  cv::Rect best;
  int fewest = std::numeric_limits<int>::max();
  for (const cv::Point corner : {cv::Point(area.cols - size.width - 6, 6),
                                 cv::Point(area.cols - size.width - 6, area.rows - size.height - 6),
                                 cv::Point(6, 6), cv::Point(6, area.rows - size.height - 6)}) {
    const cv::Rect box = cv::Rect(corner, size) & cv::Rect(0, 0, area.cols, area.rows);
    if (box.area() == 0) continue;
    const int covered = cv::countNonZero(drawn(box));
    if (covered < fewest) {
      fewest = covered;
      best = box;
    }
  }
  return best;
}

void draw_legend(cv::Mat& picture, const cv::Rect& box, const Panel& panel) {
  if (box.area() == 0) return;
  cv::rectangle(picture, box, kPaper, cv::FILLED);
  cv::rectangle(picture, box, kGrid);
  int row = 0;
  for (std::size_t n = 0; n < panel.lines.size(); ++n) {
    const Line& line = panel.lines[n];
    if (line.label.empty()) continue;
    const int y = box.y + 13 + kRow * row++;
    if (line.style == Line::Style::kPoints) {
      stroke(picture, {cv::Point2d(box.x + 6 + 0.5 * kSample, y)}, line, colour_of(line, n));
    } else {
      stroke(picture, {cv::Point2d(box.x + 6, y), cv::Point2d(box.x + 6 + kSample, y)}, line,
             colour_of(line, n));
    }
    text(picture, line.label, {box.x + 12 + kSample, y + 4});
  }
}

void draw_panel(cv::Mat picture, const Panel& panel) {
  const cv::Size legend = legend_size(panel);
  const bool beside = legend_stands_beside(legend);
  const cv::Rect box(kLeft, kTop, picture.cols - kLeft - kRight - (beside ? legend.width + 6 : 0),
                     picture.rows - kTop - kBottom);
  Axis x{0, 1, panel.log_x, 0, box.width};
  Axis y{0, 1, panel.log_y, box.height, 0};
  set_range(x, panel.lines, panel.x_range, &Line::x, 0.0);
  set_range(y, panel.lines, panel.y_range, &Line::y, 0.06);
  if (panel.equal_axes) {
    const double unit = std::max((x.high - x.low) / box.width, (y.high - y.low) / box.height) * 1.05;
    for (Axis* axis : {&x, &y}) {
      const double middle = 0.5 * (axis->low + axis->high);
      const double half = 0.5 * unit * std::abs(axis->to_px - axis->from_px);
      axis->low = middle - half;
      axis->high = middle + half;
    }
  }
  cv::Mat area = picture(box);
  for (const auto& tick : ticks_of(x, 6)) {
    const int at = cvRound(x.pixel(tick.value));
    cv::line(area, {at, 0}, {at, box.height}, kGrid);
    text(picture, tick.label, {box.x + at - size_of(tick.label).width / 2, box.y + box.height + 16});
  }
  for (const auto& tick : ticks_of(y, 5)) {
    const int at = cvRound(y.pixel(tick.value));
    cv::line(area, {0, at}, {box.width, at}, kGrid);
    text(picture, tick.label, {box.x - 6 - size_of(tick.label).width, box.y + at + 4});
  }
  draw_lines(area, panel, x, y);
  if (beside) {
    draw_legend(picture, {{box.x + box.width + 6, box.y}, legend}, panel);
  } else {
    draw_legend(area, emptiest_corner(area, legend), panel);
  }
  cv::rectangle(picture, box, kInk);
  text(picture, panel.title, {box.x + (box.width - size_of(panel.title, 0.46).width) / 2, box.y - 9}, 0.46);
  text(picture, panel.x_label,
       {box.x + (box.width - size_of(panel.x_label).width) / 2, box.y + box.height + 36});
  vertical_text(picture, panel.y_label, {12, box.y + box.height / 2});
}

}  // namespace

void draw_figure(const Figure& figure, const std::filesystem::path& png) {
  const int columns = std::max(1, figure.columns);
  const int rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  const int head = figure.title.empty() ? 0 : kTitle;
  cv::Mat picture(head + std::max(1, rows) * figure.panel_height_px, columns * figure.panel_width_px, CV_8UC3,
                  kPaper);
  if (head > 0) text(picture, figure.title, {(picture.cols - size_of(figure.title, 0.6).width) / 2, 24}, 0.6);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const int row = static_cast<int>(i) / columns, column = static_cast<int>(i) % columns;
    draw_panel(picture(cv::Rect(column * figure.panel_width_px, head + row * figure.panel_height_px,
                                figure.panel_width_px, figure.panel_height_px)),
               figure.panels[i]);
  }
  write_picture(png, picture);
}

}  // namespace telekerf::reporting
