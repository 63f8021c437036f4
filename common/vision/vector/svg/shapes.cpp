// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/shapes.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/number.h"
#include "common/vision/vector/svg/path_data.h"

namespace telekerf::vision {
namespace {

void draw_points(const char* points, bool closed, CurveWriter& w, const Eigen::Affine2d& here,
                 DrawnLines& out) {
  std::string_view text = points != nullptr ? points : "";
  bool first = true;
  while (auto x = take_number(text)) {
    const auto y = take_number(text);
    if (!y) return out.fail("a polyline has an odd number of coordinates");
    first ? w.move_to({*x, *y}) : w.line_to({*x, *y});
    first = false;
    if (w.full() || w.bad()) break;
  }
  skip_separators(text);
  if (!text.empty() && !w.full() && !w.bad()) return out.fail("a polyline's points cannot be read");
  out.add(w, here, closed);
}

void draw_rectangle(const SvgCoordinates& at, CurveWriter& w, const Eigen::Affine2d& here, DrawnLines& out) {
  const double x = at("x");
  const double y = at("y");
  const double width = at("width");
  const double height = at("height");
  if (!(width > 0.0) || !(height > 0.0)) return;
  double rx = at("rx", at("ry", 0.0));
  double ry = at("ry", rx);
  rx = std::min(std::abs(rx), 0.5 * width);
  ry = std::min(std::abs(ry), 0.5 * height);
  const Vec2 r(rx, ry);
  w.move_to({x + rx, y});
  w.line_to({x + width - rx, y});
  w.arc_to(r, 0, false, true, {x + width, y + ry});
  w.line_to({x + width, y + height - ry});
  w.arc_to(r, 0, false, true, {x + width - rx, y + height});
  w.line_to({x + rx, y + height});
  w.arc_to(r, 0, false, true, {x, y + height - ry});
  w.line_to({x, y + ry});
  w.arc_to(r, 0, false, true, {x + rx, y});
  out.add(w, here, true);
}

void draw_path(std::string_view d, CurveWriter& w, const Eigen::Affine2d& here, DrawnLines& out) {
  const auto end_subpath = [&](bool closed) {
    if (w.points().size() > 1) {
      out.add(w, here, closed);
    } else {
      w.take();
    }
  };
  PathData data(d);
  while (const auto segment = data.next()) {
    if (segment->kind == PathSegment::Kind::kMove || segment->kind == PathSegment::Kind::kClose) {
      end_subpath(segment->kind == PathSegment::Kind::kClose);
      if (out.failed()) return;
      if (segment->kind == PathSegment::Kind::kMove) w.move_to(segment->to);
      continue;
    }
    if (w.points().empty()) w.move_to(segment->from);  // drawing goes on after a close
    draw(*segment, w);
    if (w.full() || w.bad()) return out.add(w, here, false);
  }
  if (data.damaged())
    return out.fail(fmt::format("a path's data cannot be read near \"{:.30}\"", data.rest()));
  end_subpath(false);
}

}  // namespace

void draw_shape(std::string_view name, const tinyxml2::XMLElement& e, const SvgCoordinates& at,
                const Eigen::Affine2d& here, DrawnLines& out) {
  auto writer = out.writer(here);
  if (!writer) return;
  CurveWriter& w = *writer;
  if (name == "path") {
    if (const char* d = e.Attribute("d")) draw_path(d, w, here, out);
  } else if (name == "line") {
    w.move_to({at("x1"), at("y1")});
    w.line_to({at("x2"), at("y2")});
    out.add(w, here, false);
  } else if (name == "polyline" || name == "polygon") {
    draw_points(e.Attribute("points"), name == "polygon", w, here, out);
  } else if (name == "rect") {
    draw_rectangle(at, w, here, out);
  } else if (name == "circle" || name == "ellipse") {
    const double r = at("r");
    const Vec2 radii = name == "circle" ? Vec2(r, r) : Vec2(at("rx"), at("ry"));
    if (!(radii.minCoeff() > 0.0)) return;
    w.ellipse({at("cx"), at("cy")}, {radii.x(), 0}, {0, radii.y()}, 0.0, 2.0 * M_PI);
    out.add(w, here, true);
  } else {
    out.unsupported.add(name);
  }
}

}  // namespace telekerf::vision
