// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/entity_lines.h"

#include <cmath>
#include <cstddef>

#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/spline.h"

namespace telekerf::vision {
namespace {

constexpr double kSameAngle_rad = 1e-9;  ///< an end that is written with ten digits is still the start

/// Radians, above 0 and up to a full turn, which an end at the start means whatever turns lie between them.
double turn_between(double from, double to) {
  double sweep = std::fmod(to - from, 2.0 * M_PI);
  if (sweep < 0.0) sweep += 2.0 * M_PI;
  if (sweep <= kSameAngle_rad) sweep += 2.0 * M_PI;
  return sweep;
}

void draw_polyline(const DxfEntity& e, CurveWriter& w, bool closed) {
  for (std::size_t i = 0; i < e.vertices.size() && !w.full() && !w.bad(); ++i) {
    i == 0 ? w.move_to(e.vertices[0].at) : w.bulge_to(e.vertices[i - 1].bulge, e.vertices[i].at);
  }
  if (closed && e.vertices.size() > 1) w.bulge_to(e.vertices.back().bulge, e.vertices.front().at);
}

/// False where there is nothing to draw.
bool draw_spline(const DxfEntity& e, CurveWriter& w, DrawnLines& out) {
  if (e.spline.control.empty() && e.fit_points.size() > 1) {  // only the points it runs through
    for (const Vec2& p : e.fit_points) w.points().empty() ? w.move_to(p) : w.line_to(p);
    return true;
  }
  if (const auto wrong = complaint_of(e.spline)) {
    out.fail(*wrong);
    return false;
  }
  draw(e.spline, w);
  return true;
}

}  // namespace

void draw_entity(const DxfEntity& e, const Eigen::Affine2d& here, DrawnLines& out) {
  auto writer = out.writer(here);
  if (!writer) return;
  CurveWriter& w = *writer;
  const auto at = [&](int code) { return Vec2(e.number[code], e.number[code + 10]); };
  bool closed = false;
  if (e.kind == "LINE") {
    w.move_to(at(10));
    w.line_to(at(11));
  } else if (e.kind == "CIRCLE" || e.kind == "ARC") {
    const double r = e.number[40];
    if (!(r > 0.0)) return;
    const bool circle = e.kind == "CIRCLE";
    const double from = circle ? 0.0 : e.number[50] * M_PI / 180.0;
    double to = circle ? 2.0 * M_PI : e.number[51] * M_PI / 180.0;
    if (!circle) to = from + turn_between(from, to);
    w.ellipse(at(10), {r, 0}, {0, r}, from, to);
    closed = circle;
  } else if (e.kind == "ELLIPSE") {
    const Vec2 major = at(11);
    const double from = e.number[41];
    const double sweep = turn_between(from, e.number[42]);
    const double ratio = e.extruded_down ? -e.number[40] : e.number[40];
    w.ellipse(at(10), major, ratio * Vec2(-major.y(), major.x()), from, from + sweep);
    closed = sweep > 2.0 * M_PI - kSameAngle_rad;
  } else if (e.kind == "LWPOLYLINE" || e.kind == "POLYLINE") {
    if (e.kind == "POLYLINE" && (e.flags & ~(1 | 128)) != 0)
      return out.unsupported.add("fitted or 3D POLYLINE");
    closed = (e.flags & 1) != 0;
    draw_polyline(e, w, closed);
  } else if (e.kind == "SPLINE") {
    if (!draw_spline(e, w, out)) return;
    closed = (e.flags & 1) != 0;
  } else {
    return out.unsupported.add(e.kind);
  }
  out.add(w, here, closed);
}

}  // namespace telekerf::vision
