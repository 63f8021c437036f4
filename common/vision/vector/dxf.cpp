// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/dxf_blocks.h"
#include "common/vision/vector/dxf_groups.h"
#include "common/vision/vector/number.h"
#include "common/vision/vector/spline.h"
#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;

struct Vertex {
  Vec2 at = Vec2::Zero();
  double bulge = 0.0;
};

/// What an entity's groups say; only what some kind of line needs.
struct Entity {
  std::string kind;
  std::array<double, 60> number{};  ///< the last value of codes 10 .. 59
  int flags = 0;                    ///< 70
  bool invisible = false;           ///< 60 = 1
  bool on_sheet = false;            ///< 67 = 1: on the printed sheet, not in the drawing
  bool tilted = false;              ///< extruded neither up nor down
  bool extruded_down = false;       ///< 230 = -1: seen from below, x is mirrored
  std::vector<Vertex> vertices;     ///< of polylines
  Spline spline;                    ///< of a SPLINE
  std::vector<Vec2> fit_points;     ///< of a SPLINE
  DxfInsert insert;                 ///< of an INSERT
};

void absorb(std::vector<Vertex>& vertices, int code, double value) {
  if (code == 10) vertices.push_back({Vec2(value, 0.0), 0.0});
  if (vertices.empty()) return;
  if (code == 20) vertices.back().at.y() = value;
  if (code == 42) vertices.back().bulge = value;
}

void absorb(Spline& spline, int code, double value) {
  if (code == 71) spline.degree = static_cast<int>(std::clamp(value, 0.0, 100.0));
  if (code == 40) spline.knots.push_back(value);
  if (code == 41) spline.weights.push_back(value);
  if (code == 10) spline.control.emplace_back(value, 0.0);
  if (code == 20 && !spline.control.empty()) spline.control.back().y() = value;
}

void absorb(DxfInsert& insert, int code, double value) {
  if (code == 10) insert.at.x() = value;
  if (code == 20) insert.at.y() = value;
  if (code == 41) insert.scale.x() = value;
  if (code == 42) insert.scale.y() = value;
  if (code == 50) insert.angle_deg = value;
  if (code == 44) insert.spacing.x() = value;
  if (code == 45) insert.spacing.y() = value;
  if (code == 70) insert.columns = static_cast<int>(std::clamp(value, 1.0, 1e6));
  if (code == 71) insert.rows = static_cast<int>(std::clamp(value, 1.0, 1e6));
}

/// Adds one group to the entity under construction; false when a number cannot be read.
bool absorb(Entity& e, const DxfGroup& g) {
  if (g.code == 2 && e.kind == "INSERT") e.insert.block = g.value;
  const bool wanted = (g.code >= 10 && g.code <= 60) || g.code == 67 || g.code == 70 || g.code == 71 ||
                      (g.code >= 210 && g.code <= 230);
  if (!wanted) return true;
  std::string_view text = g.value;
  const auto value = take_number(text);
  if (!value) return false;
  if (g.code < 60) e.number[g.code] = *value;
  if (g.code == 60) e.invisible = *value != 0.0;
  if (g.code == 67) e.on_sheet = *value != 0.0;
  if (g.code == 70) e.flags = static_cast<int>(std::clamp(*value, -32768.0, 65535.0));
  if (g.code == 210 || g.code == 220) e.tilted = e.tilted || std::abs(*value) > 1e-9;
  if (g.code == 230) e.extruded_down = *value < 0.0;
  if (e.kind == "LWPOLYLINE") absorb(e.vertices, g.code, *value);
  if (e.kind == "SPLINE") absorb(e.spline, g.code, *value);
  if (e.kind == "SPLINE" && g.code == 11) e.fit_points.emplace_back(*value, 0.0);
  if (e.kind == "SPLINE" && g.code == 21 && !e.fit_points.empty()) e.fit_points.back().y() = *value;
  if (e.kind == "INSERT") absorb(e.insert, g.code, *value);
  return true;
}

/// What draws nothing of its own: windows onto the drawing, and marks of where something ends.
bool draws_nothing(const Entity& e) {
  return e.invisible || e.kind == "VIEWPORT" || e.kind == "SEQEND" || e.kind == "ATTDEF";
}

class Reader {
 public:
  Reader(const DxfContents& contents, const VectorLimits& limits)
      : contents_(contents),
        most_groups_(limits.most_bytes / 4),
        out_(limits, Vec2::Constant(contents.metres)) {}

  tl::expected<VectorDrawing, std::string> drawing() { return out_.drawing("DXF"); }

  /// Draws what a section or a block holds.
  void draw(const DxfPart& part, const Affine& here) {
    DxfGroups groups(part.entities, part.line);
    std::optional<Entity> entity;    // being read
    std::optional<Entity> polyline;  // an old POLYLINE that collects its VERTEX entities
    const auto flush = [&] {
      if (!entity) return;
      if (entity->kind == "POLYLINE") {
        polyline = std::exchange(entity, std::nullopt);
      } else if (entity->kind == "VERTEX" && polyline) {
        polyline->vertices.push_back({Vec2(entity->number[10], entity->number[20]), entity->number[42]});
      } else if (entity->kind == "SEQEND" && polyline) {
        draw(*polyline, here);
        polyline.reset();
      } else {
        draw(*entity, here);
      }
      entity.reset();
    };
    while (!out_.failed()) {
      const auto group = groups.next();
      if (!group) break;
      if (++groups_read_ > most_groups_) return out_.fail("blocks are inserted too often to be drawn");
      if (group->code == 0) {
        flush();
        entity.emplace();
        entity->kind = group->value.substr(0, 32);
      } else if (entity && !absorb(*entity, *group)) {
        return out_.fail(
            fmt::format("line {}: \"{:.40}\" is not a finite number", groups.line_number(), group->value));
      }
    }
    flush();
    if (polyline) draw(*polyline, here);
  }

 private:
  void draw(const Entity& e, const Affine& outer) {
    if (out_.failed() || draws_nothing(e)) return;
    if (e.on_sheet) return out_.left_out.add(e.kind + " on a sheet");
    if (e.tilted) return out_.left_out.add("tilted " + e.kind);
    Affine here = outer;
    // These are given in coordinates of their own plane, the others in those of the drawing.
    for (const std::string_view planar : {"CIRCLE", "ARC", "LWPOLYLINE", "POLYLINE", "INSERT"}) {
      if (e.extruded_down && e.kind == planar) here.scale(Vec2(-1.0, 1.0));
    }
    if (e.kind == "INSERT") return insert(e.insert, here);
    auto writer = out_.writer(here);
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
      closed = sweep > 2.0 * M_PI - 1e-9;
    } else if (e.kind == "LWPOLYLINE" || e.kind == "POLYLINE") {
      if (e.kind == "POLYLINE" && (e.flags & ~(1 | 128)) != 0)
        return out_.left_out.add("fitted or 3D POLYLINE");
      closed = (e.flags & 1) != 0;
      polyline(e, w, closed);
    } else if (e.kind == "SPLINE") {
      if (!spline(e, w)) return;
      closed = (e.flags & 1) != 0;
    } else {
      return out_.left_out.add(e.kind);
    }
    out_.add(w, here, closed);
  }

  void insert(const DxfInsert& insert, const Affine& here) {
    const auto block = block_of(insert, contents_);
    if (!block) return out_.fail(block.error());
    if (++depth_ > kDeepest)
      return out_.fail(fmt::format("block \"{:.40}\" is nested too deeply or in itself", insert.block));
    for (int row = 0; row < insert.rows && !out_.failed(); ++row) {
      for (int column = 0; column < insert.columns && !out_.failed(); ++column) {
        if (++groups_read_ > most_groups_) return out_.fail("blocks are inserted too often to be drawn");
        draw(block->part, place_of(insert, *block, row, column, here));
      }
    }
    --depth_;
  }

  static double turn_between(double from, double to) {
    double sweep = std::fmod(to - from, 2.0 * M_PI);
    if (sweep <= 1e-12) sweep += 2.0 * M_PI;
    return sweep;
  }

  static void polyline(const Entity& e, CurveWriter& w, bool closed) {
    for (std::size_t i = 0; i < e.vertices.size() && !w.full() && !w.bad(); ++i) {
      i == 0 ? w.move_to(e.vertices[0].at) : w.bulge_to(e.vertices[i - 1].bulge, e.vertices[i].at);
    }
    if (closed && e.vertices.size() > 1) w.bulge_to(e.vertices.back().bulge, e.vertices.front().at);
  }

  bool spline(const Entity& e, CurveWriter& w) {
    if (e.spline.control.empty() && e.fit_points.size() > 1) {  // only the points it runs through
      for (const Vec2& p : e.fit_points) w.points().empty() ? w.move_to(p) : w.line_to(p);
      return true;
    }
    if (const auto wrong = complaint_of(e.spline)) {
      out_.fail(*wrong);
      return false;
    }
    vision::draw(e.spline, w);
    return true;
  }

  static constexpr int kDeepest = 32;

  const DxfContents& contents_;
  std::size_t most_groups_;  ///< reading a file of that size without blocks takes about as long
  std::size_t groups_read_ = 0;
  int depth_ = 0;  ///< of blocks within blocks
  DrawnLines out_;
};

}  // namespace

tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.most_bytes) {
    return tl::unexpected(fmt::format("the DXF file is larger than {} MB", limits.most_bytes / 1000000));
  }
  if (text.substr(0, 18) == "AutoCAD Binary DXF") {
    return tl::unexpected<std::string>("binary DXF is not read; save the drawing as ASCII DXF");
  }
  const auto contents = contents_of(text);
  if (!contents) return tl::unexpected(contents.error());
  Reader reader(*contents, limits);
  for (const DxfPart& section : contents->drawn) reader.draw(section, Affine::Identity());
  return reader.drawing();
}

}  // namespace telekerf::vision
