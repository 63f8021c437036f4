// SPDX-License-Identifier: Apache-2.0
#include "tools/draw-pictures/drawing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace telekerf::drawing {
namespace {

using geometry::Polyline;

/// A curve over 0..1 in units of a shape of about radius 1, y upwards.
using Curve = std::function<Vec2(double)>;

Polyline sampled(const Curve& curve, int points, bool closed) {
  Polyline out{{}, closed};
  for (int i = 0; i < points; ++i) out.points_m.push_back(curve(double(i) / (closed ? points : points - 1)));
  return out;
}

Vec2 polar(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

/// A Bezier chain of cubics: 3 n + 1 control points.
Polyline bezier(const std::vector<Vec2>& c, bool closed, int steps = 60) {
  Polyline out{{}, closed};
  for (std::size_t i = 0; i + 3 < c.size(); i += 3) {
    for (int k = 0; k < steps; ++k) {
      const double t = double(k) / steps;
      const double u = 1.0 - t;
      out.points_m.push_back(u * u * u * c[i] + 3 * u * u * t * c[i + 1] + 3 * u * t * t * c[i + 2] +
                             t * t * t * c[i + 3]);
    }
  }
  if (!closed) out.points_m.push_back(c.back());
  return out;
}

/// 24 teeth with straight flanks between the circles of radius 0.84 and 1.
Polyline gear() {
  Polyline out{{}, true};
  constexpr int kTeeth = 24;
  for (int tooth = 0; tooth < kTeeth; ++tooth) {
    const double pitch = 2.0 * M_PI / kTeeth;
    const double at = tooth * pitch;
    for (const auto& [part, radius] :
         {std::pair{0.0, 0.84}, {0.28, 0.84}, {0.40, 1.0}, {0.62, 1.0}, {0.74, 0.84}}) {
      out.points_m.push_back(polar(radius, at + part * pitch));
    }
  }
  return out;
}

/// A heart as a hand draws it: the curve of the textbooks with a slow tremble.
Vec2 heart(double t) {
  const double a = 2.0 * M_PI * t;
  const Vec2 ideal(16.0 * std::pow(std::sin(a), 3), 13.0 * std::cos(a) - 5.0 * std::cos(2 * a) -
                                                        2.0 * std::cos(3 * a) - std::cos(4 * a) + 2.5);
  const double tremble =
      0.012 * std::sin(7 * a + 0.4) + 0.008 * std::sin(11 * a + 1.9) + 0.005 * std::sin(17 * a);
  return (1.0 + tremble) * ideal / 17.0;
}

/// The cam of an eight-legged machine: a foot path with a flat side.
Vec2 cam(double t) {
  const double a = 2.0 * M_PI * t;
  return polar(0.62 + 0.22 * std::cos(a) + 0.10 * std::cos(2 * a + 0.6) + 0.05 * std::cos(3 * a), a);
}

Vec2 blob(double t) {
  const double a = 2.0 * M_PI * t;
  return polar(0.72 + 0.11 * std::cos(2 * a + 0.3) + 0.07 * std::sin(3 * a) + 0.045 * std::cos(5 * a + 1.0) +
                   0.02 * std::sin(9 * a + 2.0),
               a);
}

/// A bold printed e: a ring with a bar, cut open below the bar.
std::vector<Polyline> letter_e() {
  constexpr double kOuter = 0.92;
  constexpr double kInner = 0.56;
  constexpr double kBar = 0.13;  // half height of the bar
  Polyline outer{{}, true};
  const double mouth = -0.62;  // where the tail ends
  const double bar_angle = std::asin(-kBar / kOuter);
  for (int i = 0; i <= 300; ++i) {
    outer.points_m.push_back(polar(kOuter, bar_angle + (2 * M_PI + mouth - bar_angle) * i / 300.0));
  }
  const double below = M_PI - std::asin(-kBar / kInner);  // inner ring, left, under the bar
  for (int i = 0; i <= 150; ++i) {
    outer.points_m.push_back(polar(kInner, 2 * M_PI + mouth + (below - 2 * M_PI - mouth) * i / 150.0));
  }
  Polyline counter{{}, true};
  const double above = std::asin(kBar / kInner);
  for (int i = 0; i <= 150; ++i)
    counter.points_m.push_back(polar(kInner, above + (M_PI - 2 * above) * i / 150.0));
  return {outer, counter};
}

struct Shape {
  std::vector<Polyline> lines;
  bool filled = false;
  double pen_px = 5.0;
};

const std::map<std::string, std::function<Shape()>, std::less<>>& shapes() {
  static const std::map<std::string, std::function<Shape()>, std::less<>> all{
      {"line",
       [] {
         return Shape{{Polyline{{{-1.0, -0.4}, {1.0, 0.45}}, false}}};
       }},
      {"circle",
       [] { return Shape{{sampled([](double t) { return polar(0.9, 2 * M_PI * t); }, 720, true)}}; }},
      {"figure-8",
       [] {
         return Shape{{sampled(
             [](double t) {
               const double a = 2 * M_PI * t + 0.3;
               return Vec2(1.15 * std::sin(a), 0.95 * std::sin(a) * std::cos(a));
             },
             720, true)}};
       }},
      {"spiral",
       [] {
         return Shape{
             {sampled([](double t) { return polar(0.14 + 0.82 * t, 2 * M_PI * 3.2 * t); }, 1500, false)}};
       }},
      {"heart",
       [] {
         return Shape{{sampled(heart, 900, true)}, false, 5.0};
       }},
      {"gear",
       [] {
         return Shape{{gear()}, true};
       }},
      {"cam",
       [] {
         return Shape{{sampled(cam, 900, true)}, true};
       }},
      {"blob",
       [] {
         return Shape{{sampled(blob, 900, true)}, true};
       }},
      {"octagon",
       [] {
         return Shape{{sampled([](double t) { return polar(0.95, 2 * M_PI * t + M_PI / 8); }, 8, true)},
                      true};
       }},
      {"letter-e",
       [] {
         return Shape{letter_e(), true};
       }},
      {"letter-s",
       [] {
         return Shape{{bezier({{0.58, 0.62},
                               {0.42, 1.05},
                               {-0.58, 1.08},
                               {-0.58, 0.48},
                               {-0.58, -0.06},
                               {0.62, 0.10},
                               {0.62, -0.45},
                               {0.62, -1.06},
                               {-0.48, -1.06},
                               {-0.64, -0.60}},
                              false)},
                      false,
                      8.0};
       }},
      {"script-e",
       [] {
         return Shape{{bezier({{-1.25, -0.35},
                               {-0.55, -0.30},
                               {0.62, 0.05},
                               {0.62, 0.55},
                               {0.62, 1.05},
                               {-0.60, 1.00},
                               {-0.60, 0.05},
                               {-0.60, -0.95},
                               {0.55, -0.95},
                               {1.20, -0.20}},
                              false)},
                      false,
                      7.0};
       }},
      {"flange", [] {
         Shape shape{{sampled([](double t) { return polar(0.95, 2 * M_PI * t); }, 360, true)}, true};
         for (int i = 0; i < 5; ++i) {
           const Vec2 at = polar(0.66, 2 * M_PI * i / 5.0 + 0.3);
           shape.lines.push_back(
               sampled([&](double t) { return Vec2(at + polar(0.13, 2 * M_PI * t)); }, 120, true));
         }
         shape.lines.push_back(sampled([](double t) { return polar(0.3, 2 * M_PI * t); }, 240, true));
         return shape;
       }}};
  return all;
}

}  // namespace

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& [name, shape] : shapes()) out.push_back(name);
  return out;
}

std::optional<Drawing> by_name(std::string_view name, int width_px, int height_px) {
  const auto found = shapes().find(name);
  if (found == shapes().end()) return std::nullopt;
  Shape shape = found->second();
  const double gain = 0.42 * std::min(width_px, height_px);
  Drawing out{std::move(shape.lines), shape.filled, shape.pen_px};
  for (Polyline& line : out.lines_px) {
    for (Vec2& p : line.points_m) {
      p = Vec2(0.5 * (width_px - 1) + gain * p.x(), 0.5 * (height_px - 1) - gain * p.y());
    }
  }
  return out;
}

Drawing transformed(const Drawing& drawing, double angle_rad, double gain, const Vec2& centre_px,
                    const Vec2& shift_px) {
  Drawing out = drawing;
  const double c = gain * std::cos(angle_rad);
  const double s = gain * std::sin(angle_rad);
  for (Polyline& line : out.lines_px) {
    for (Vec2& p : line.points_m) {
      const Vec2 d = p - centre_px;
      p = centre_px + shift_px + Vec2(c * d.x() - s * d.y(), s * d.x() + c * d.y());
    }
  }
  out.pen_px *= gain;
  return out;
}

}  // namespace telekerf::drawing
