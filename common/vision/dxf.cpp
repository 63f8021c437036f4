// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/vision/curves.h"
#include "common/vision/number.h"
#include "common/vision/vector_drawing.h"

namespace telekerf::vision {
namespace {

/// One pair of lines of the file: a group code and its value.
struct Group {
  int code = 0;
  std::string_view value;
};

class Groups {
 public:
  explicit Groups(std::string_view text) : text_(text) {}

  /// The next group; nothing at the end, or where the file is damaged (then `damaged`).
  std::optional<Group> next() {
    if (text_.empty()) return std::nullopt;
    const std::string_view first = line();
    if (text_.empty() && first.empty()) return std::nullopt;
    std::string_view digits = first;
    const auto code = take_number(digits);
    if (!code || *code != std::floor(*code) || std::abs(*code) > 10000 || ended_) {
      damaged = true;
      return std::nullopt;
    }
    return Group{static_cast<int>(*code), line()};
  }
  bool damaged = false;
  std::size_t line_number() const { return lines_; }

 private:
  std::string_view line() {
    ++lines_;
    const auto end = text_.find('\n');
    std::string_view out = text_.substr(0, end);
    if (end == std::string_view::npos) ended_ = true;
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    while (!out.empty() && (out.back() == '\r' || out.back() == ' ' || out.back() == '\t'))
      out.remove_suffix(1);
    while (!out.empty() && (out.front() == ' ' || out.front() == '\t')) out.remove_prefix(1);
    return out;
  }
  std::string_view text_;
  std::size_t lines_ = 0;
  bool ended_ = false;
};

/// $INSUNITS -> metres; unitless drawings are taken as millimetres.
std::optional<double> metres_of_unit(int unit) {
  switch (unit) {
    case 0:
      return 1e-3;
    case 1:
      return 25.4e-3;
    case 2:
      return 0.3048;
    case 4:
      return 1e-3;
    case 5:
      return 1e-2;
    case 6:
      return 1.0;
    case 8:
      return 25.4e-9;
    case 9:
      return 25.4e-6;
    case 10:
      return 0.9144;
    case 12:
      return 1e-9;
    case 13:
      return 1e-6;
    case 14:
      return 0.1;
    default:
      return std::nullopt;
  }
}

struct Vertex {
  Vec2 at = Vec2::Zero();
  double bulge = 0.0;
};

/// What an entity's groups say; only what some kind of line needs.
struct Entity {
  std::string kind;
  std::array<double, 60> number{};  ///< the last value of codes 10 .. 59
  int flags = 0;                    ///< 70
  int degree = 3;                   ///< 71
  bool extruded_down = false;       ///< 230 = -1: seen from below, x is mirrored
  std::vector<Vertex> vertices;     ///< of polylines, or control points
  std::vector<Vec2> fit_points;
  std::vector<double> knots;
  std::vector<double> weights;
};

/// de Boor's algorithm in homogeneous coordinates; `span` holds knots[span] <= t < knots[span + 1].
Vec2 spline_point(const Entity& e, double t, std::size_t span) {
  std::array<Eigen::Vector3d, 12> d;
  const auto p = static_cast<std::size_t>(e.degree);
  for (std::size_t j = 0; j <= p; ++j) {
    const std::size_t i = span - p + j;
    const double w = e.weights.empty() ? 1.0 : e.weights[i];
    d[j] = {w * e.vertices[i].at.x(), w * e.vertices[i].at.y(), w};
  }
  for (std::size_t r = 1; r <= p; ++r) {
    for (std::size_t j = p; j >= r; --j) {
      const double low = e.knots[span - p + j];
      const double high = e.knots[span + 1 + j - r];
      const double a = high > low ? (t - low) / (high - low) : 0.0;
      d[j] = (1.0 - a) * d[j - 1] + a * d[j];
    }
  }
  return d[p].head<2>() / d[p].z();
}

class Reader {
 public:
  explicit Reader(const VectorLimits& limits) : limits_(limits), room_(limits.most_points) {}

  std::vector<geometry::Polyline> lines;
  std::string complaint;
  double metres = 1e-3;
  std::size_t ignored = 0;

  void draw(const Entity& e) {
    if (!complaint.empty()) return;
    CurveWriter w(limits_.chord_error_m / metres, room_);
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
      w.ellipse(at(10), major, e.number[40] * Vec2(-major.y(), major.x()), from, from + sweep);
      closed = sweep > 2.0 * M_PI - 1e-9;
    } else if (e.kind == "LWPOLYLINE" || e.kind == "POLYLINE") {
      if (e.kind == "POLYLINE" && (e.flags & ~(1 | 128)) != 0) return void(++ignored);  // splines, meshes, 3D
      closed = (e.flags & 1) != 0;
      polyline(e, w, closed);
    } else if (e.kind == "SPLINE") {
      if (!spline(e, w)) return;
      closed = (e.flags & 1) != 0;
    } else {
      ++ignored;
      return;
    }
    finish(w, closed, e.extruded_down);
  }

 private:
  static double turn_between(double from, double to) {
    double sweep = std::fmod(to - from, 2.0 * M_PI);
    if (sweep <= 1e-12) sweep += 2.0 * M_PI;
    return sweep;
  }

  void fail(std::string sentence) {
    if (complaint.empty()) complaint = std::move(sentence);
  }

  void finish(CurveWriter& w, bool closed, bool mirrored) {
    if (w.bad()) return fail("a coordinate is not a finite number");
    if (w.full()) return fail(fmt::format("the drawing has more than {} points", limits_.most_points));
    geometry::Polyline line{w.take(), closed};
    room_ -= std::min(room_, line.size());
    for (Vec2& p : line.points_m) p = metres * Vec2(mirrored ? -p.x() : p.x(), p.y());
    if (!geometry::all_finite(line.points_m)) return fail("a coordinate is not a finite number");
    line = geometry::without_duplicates(line, closed ? 1e-12 : 0.0);
    if (line.size() >= 2) lines.push_back(std::move(line));
  }

  static void polyline(const Entity& e, CurveWriter& w, bool closed) {
    for (std::size_t i = 0; i < e.vertices.size() && !w.full() && !w.bad(); ++i) {
      i == 0 ? w.move_to(e.vertices[0].at) : w.bulge_to(e.vertices[i - 1].bulge, e.vertices[i].at);
    }
    if (closed && e.vertices.size() > 1) w.bulge_to(e.vertices.back().bulge, e.vertices.front().at);
  }

  bool spline(const Entity& e, CurveWriter& w) {
    const std::size_t n = e.vertices.size();
    if (n == 0 && e.fit_points.size() > 1) {  // only the points it runs through
      for (std::size_t i = 0; i < e.fit_points.size(); ++i) {
        i == 0 ? w.move_to(e.fit_points[i]) : w.line_to(e.fit_points[i]);
      }
      return true;
    }
    const auto p = static_cast<std::size_t>(std::max(0, e.degree));
    if (p < 1 || p > 10 || n <= p || e.knots.size() != n + p + 1 ||
        !std::is_sorted(e.knots.begin(), e.knots.end()) || (!e.weights.empty() && e.weights.size() != n)) {
      fail("a SPLINE's degree, knots and control points do not fit together");
      return false;
    }
    for (const double weight : e.weights) {
      if (!(weight > 0.0)) {
        fail("a SPLINE has a weight that is not positive");
        return false;
      }
    }
    // Polygon length bounds the curve's, and each span bends no more than its control polygon: halve until
    // flat.
    for (std::size_t span = p; span < n; ++span) {
      const double from = e.knots[span];
      const double to = e.knots[span + 1];
      if (!(to > from)) continue;
      if (w.points().empty()) w.move_to(spline_point(e, from, span));
      double bend = 0.0;
      for (std::size_t j = span - p; j + 2 <= span; ++j) {
        bend = std::max(bend, (e.vertices[j].at - 2.0 * e.vertices[j + 1].at + e.vertices[j + 2].at).norm());
      }
      // |r''| over a span of parameter length 1 is at most about p^2 times the second difference; weights can
      // double that.
      const double gain = static_cast<double>(p * p) * (e.weights.empty() ? 1.0 : 4.0);
      const double steps =
          std::clamp(std::ceil(std::sqrt(gain * bend / (8.0 * limits_.chord_error_m / metres))), 1.0, 1e6);
      for (double i = 1.0; i <= steps && !w.full() && !w.bad(); i += 1.0) {
        w.line_to(spline_point(e, from + (to - from) * i / steps, span));
      }
    }
    return true;
  }

  const VectorLimits& limits_;
  std::size_t room_;
};

/// Adds one group to the entity under construction; false when a number cannot be read.
bool absorb(Entity& e, const Group& g) {
  if (g.code < 10 || g.code > 239) return true;
  if (g.code >= 60 && g.code != 70 && g.code != 71 && g.code != 230) return true;
  std::string_view text = g.value;
  const auto value = take_number(text);
  if (!value) return false;
  if (g.code == 70) e.flags = static_cast<int>(std::clamp(*value, -32768.0, 65535.0));
  if (g.code == 71) e.degree = static_cast<int>(std::clamp(*value, 0.0, 100.0));
  if (g.code == 230) e.extruded_down = *value < 0.0;
  if (g.code >= 60) return true;
  const bool many = e.kind == "LWPOLYLINE" || e.kind == "SPLINE";
  if (many && g.code == 10) e.vertices.push_back({Vec2(*value, 0.0), 0.0});
  if (many && g.code == 20 && !e.vertices.empty()) e.vertices.back().at.y() = *value;
  if (e.kind == "LWPOLYLINE" && g.code == 42 && !e.vertices.empty()) e.vertices.back().bulge = *value;
  if (e.kind == "SPLINE") {
    if (g.code == 40) e.knots.push_back(*value);
    if (g.code == 41) e.weights.push_back(*value);
    if (g.code == 11) e.fit_points.emplace_back(*value, 0.0);
    if (g.code == 21 && !e.fit_points.empty()) e.fit_points.back().y() = *value;
  }
  e.number[g.code] = *value;
  return true;
}

}  // namespace

tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.most_bytes) {
    return tl::unexpected(fmt::format("the DXF file is larger than {} MB", limits.most_bytes / 1000000));
  }
  if (text.substr(0, 18) == "AutoCAD Binary DXF") {
    return tl::unexpected<std::string>("binary DXF is not read; save the drawing as ASCII DXF");
  }
  Groups groups(text);
  Reader reader(limits);
  std::string_view section;
  std::string_view variable;
  std::optional<Entity> entity;    // being read
  std::optional<Entity> polyline;  // an old POLYLINE that collects its VERTEX entities
  bool any_section = false;
  const auto flush = [&] {
    if (!entity) return;
    if (entity->kind == "POLYLINE") {
      polyline = std::move(entity);
    } else if (entity->kind == "VERTEX" && polyline) {
      polyline->vertices.push_back({Vec2(entity->number[10], entity->number[20]), entity->number[42]});
    } else if (entity->kind == "SEQEND" && polyline) {
      reader.draw(*polyline);
      polyline.reset();
    } else {
      reader.draw(*entity);
    }
    entity.reset();
  };
  while (const auto group = groups.next()) {
    if (!reader.complaint.empty()) break;
    if (group->code == 0) {
      flush();
      if (group->value == "SECTION" || group->value == "ENDSEC" || group->value == "EOF") {
        section = {};
        any_section = true;
        if (group->value == "EOF") break;
        continue;
      }
      if (section == "ENTITIES") entity.emplace().kind = std::string(group->value.substr(0, 32));
    } else if (group->code == 2 && section.empty()) {
      section = group->value;
    } else if (section == "HEADER") {
      if (group->code == 9) variable = group->value;
      if (variable == "$INSUNITS" && group->code == 70) {
        std::string_view digits = group->value;
        const auto unit = take_number(digits);
        const auto metres =
            unit ? metres_of_unit(static_cast<int>(std::clamp(*unit, -1.0, 100.0))) : std::nullopt;
        if (!metres)
          return tl::unexpected(
              fmt::format("$INSUNITS {:.20} is not a unit that is understood", group->value));
        reader.metres = *metres;
      }
    } else if (entity && !absorb(*entity, *group)) {
      return tl::unexpected(
          fmt::format("line {}: \"{:.40}\" is not a finite number", groups.line_number(), group->value));
    }
  }
  if (groups.damaged)
    return tl::unexpected(fmt::format("not a DXF file, or damaged, near line {}", groups.line_number()));
  flush();
  if (polyline) reader.draw(*polyline);
  if (!reader.complaint.empty()) return tl::unexpected(reader.complaint);
  VectorDrawing out;
  out.contours = joined(std::move(reader.lines), 1e-8);
  if (out.contours.empty()) {
    return tl::unexpected(
        any_section
            ? fmt::format("the DXF file draws no line that is understood ({} other entities)", reader.ignored)
            : std::string("not a DXF file"));
  }
  return out;
}

}  // namespace telekerf::vision
