// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/entity_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/fit_points.h"
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

/// The vertices that the line runs through: those of a control frame are none of them.
std::vector<DxfVertex> vertices_of(const DxfEntity& e) {
  constexpr int kControl = 16;
  std::vector<DxfVertex> out;
  for (const DxfVertex& v : e.vertices) {
    if ((v.flags & kControl) == 0) out.push_back(v);
  }
  return out;
}

constexpr double kOneHeight = 1e-6;  ///< heights that differ by less than this share of the size are one

bool is_flat(const std::vector<DxfVertex>& vertices) {
  double low = INFINITY;
  double high = -INFINITY;
  double size = 0.0;
  for (const DxfVertex& v : vertices) {
    low = std::min(low, v.z);
    high = std::max(high, v.z);
    size = std::max(size, (v.at - vertices.front().at).norm());
  }
  return !(high - low > kOneHeight * size);
}

/// Likewise for a LINE, SPLINE or ELLIPSE (whose 31 is the height of its long axis' end above its middle).
bool is_flat(const DxfEntity& e) {
  const Vec2 first(e.number[10], e.number[20]);
  const Vec2 second(e.number[11], e.number[21]);
  if (e.kind == "ELLIPSE") return !(std::abs(e.number[31]) > kOneHeight * second.norm());
  std::vector<Vec2> points = e.spline.control;
  if (e.kind == "LINE") points = {first, second};
  points.insert(points.end(), e.fit_points.begin(), e.fit_points.end());
  return !(e.highest_z - e.lowest_z > kOneHeight * geometry::bounding_box(points).size().norm());
}

/// The first of the groups without which the entity has no place or size; 0: none is missing.
int missing(const DxfEntity& e) {
  const auto first_of = [&](std::initializer_list<int> codes) {
    for (const int code : codes) {
      if (!e.given[static_cast<std::size_t>(code)]) return code;
    }
    return 0;
  };
  if (e.kind == "LINE") return first_of({10, 20, 11, 21});
  if (e.kind == "CIRCLE") return first_of({10, 20, 40});
  if (e.kind == "ARC") return first_of({10, 20, 40, 50, 51});
  if (e.kind == "ELLIPSE") return first_of({10, 20, 11, 21, 40, 41, 42});
  return 0;
}

void draw_polyline(const std::vector<DxfVertex>& v, CurveWriter& w, bool closed) {
  for (std::size_t i = 0; i < v.size() && !w.full() && !w.bad(); ++i) {
    i == 0 ? w.move_to(v[0].at) : w.bulge_to(v[i - 1].bulge, v[i].at);
  }
  if (closed && v.size() > 1) w.bulge_to(v.back().bulge, v.front().at);
}

/// False where there is nothing to draw.
bool draw_spline(const DxfEntity& e, CurveWriter& w, DrawnLines& out) {
  if (e.spline.control.empty() && e.fit_points.size() > 1) {  // only the points it runs through
    const FitPoints fit{e.fit_points, Vec2(e.number[12], e.number[22]), Vec2(e.number[13], e.number[23]),
                        (e.flags & 1) != 0};
    draw(fit, w);
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
  if (const int code = missing(e); code != 0)
    return out.fail(fmt::format("a {} has no group {}: the file is damaged", e.kind, code));
  const bool spatial = e.kind == "LINE" || e.kind == "SPLINE" || e.kind == "ELLIPSE";
  if (spatial && !is_flat(e)) return out.unsupported.add(e.kind + " that is not flat");
  if (e.kind == "LINE") {
    w.move_to(at(10));
    w.line_to(at(11));
  } else if (e.kind == "CIRCLE" || e.kind == "ARC") {
    const double r = e.number[40];
    if (!(r > 0.0)) return out.unsupported.add(e.kind + " without a radius");
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
    constexpr int kMesh = 16 | 64;
    if (e.kind == "POLYLINE" && (e.flags & kMesh) != 0) return out.unsupported.add("POLYLINE mesh");
    const std::vector<DxfVertex> vertices = vertices_of(e);
    if (e.kind == "POLYLINE" && !is_flat(vertices)) return out.unsupported.add("POLYLINE that is not flat");
    closed = (e.flags & 1) != 0;
    draw_polyline(vertices, w, closed);
  } else if (e.kind == "SPLINE") {
    if (!draw_spline(e, w, out)) return;
    closed = (e.flags & 1) != 0;
  } else {
    return out.unsupported.add(e.kind);
  }
  out.add(w, here, closed);
}

}  // namespace telekerf::vision
