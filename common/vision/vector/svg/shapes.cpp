// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/shapes.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/number.h"
#include "common/vision/vector/svg/path_data.h"

namespace telekerf::vision {
namespace {

/// Where `data` cannot be read on, with what stands round the place in letters that can be printed. `rest`:
/// what of it is not read yet. `what`: "a path's data".
std::string damage(std::string_view what, std::string_view data, std::string_view rest) {
  const std::size_t at = data.size() - rest.size();
  const std::size_t from = at < 20 ? 0 : at - 20;
  std::string near(data.substr(from, at - from + 20));
  std::replace_if(
      near.begin(), near.end(), [](char c) { return c < ' ' || c > '~'; }, ' ');
  return fmt::format("{} cannot be read near \"{}\" (character {} of {})", what, near,
                     std::min(at + 1, data.size()), data.size());
}

void draw_points(const char* points, bool closed, CurveWriter& w, const Eigen::Affine2d& here,
                 DrawnLines& out) {
  const std::string_view data = points != nullptr ? points : "";
  std::string_view text = data;
  bool first = true;
  while (auto x = take_number(text)) {
    const auto y = take_number(text);
    if (!y) return out.fail(damage("a polyline has an odd number of coordinates: its points", data, text));
    first ? w.move_to({*x, *y}) : w.line_to({*x, *y});
    first = false;
    if (w.full() || w.bad()) break;
  }
  skip_separators(text);
  if (!text.empty() && !w.full() && !w.bad()) return out.fail(damage("a polyline's points", data, text));
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
  if (data.damaged()) return out.fail(damage("a path's data", d, data.rest()));
  end_subpath(false);
}

/// The path of a style: path("M ..."), or the attribute.
std::string_view path_of(const tinyxml2::XMLElement& e, const Properties& own) {
  const char* attribute = e.Attribute("d");
  std::string_view text = attribute != nullptr ? attribute : "";
  if (const auto styled = own.find("d"); styled != own.end()) {
    text = styled->second;
    if (text == "none") return {};
    const auto open = text.find_first_of("\"'");
    const auto close = text.find_last_of("\"'");
    if (text.starts_with("path(") && close > open) text = text.substr(open + 1, close - open - 1);
  }
  return text;
}

}  // namespace

bool draw_shape(std::string_view name, const tinyxml2::XMLElement& e, const Properties& own,
                const SvgCoordinates& at, const Eigen::Affine2d& here, DrawnLines& out) {
  constexpr std::array<std::string_view, 7> kShapes{"path", "line",   "polyline", "polygon",
                                                    "rect", "circle", "ellipse"};
  if (std::find(kShapes.begin(), kShapes.end(), name) == kShapes.end()) return false;
  auto writer = out.writer(here);
  if (!writer) return true;
  CurveWriter& w = *writer;
  if (name == "path") {
    draw_path(path_of(e, own), w, here, out);
  } else if (name == "line") {
    w.move_to({at("x1"), at("y1")});
    w.line_to({at("x2"), at("y2")});
    out.add(w, here, false);
  } else if (name == "polyline" || name == "polygon") {
    draw_points(e.Attribute("points"), name == "polygon", w, here, out);
  } else if (name == "rect") {
    draw_rectangle(at, w, here, out);
  } else {
    const double r = at("r");
    Vec2 radii = name == "circle" ? Vec2(r, r) : Vec2(at("rx", at("ry")), at("ry", at("rx")));
    if (!(radii.minCoeff() > 0.0)) return true;
    w.ellipse({at("cx"), at("cy")}, {radii.x(), 0}, {0, radii.y()}, 0.0, 2.0 * M_PI);
    out.add(w, here, true);
  }
  return true;
}

}  // namespace telekerf::vision
