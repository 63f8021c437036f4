// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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
  /// `line` is where the text begins in its file.
  explicit Groups(std::string_view text, std::size_t line = 0) : text_(text), lines_(line) {}

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
  std::string_view rest() const { return text_; }

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
  std::size_t lines_;
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
  std::string_view block;           ///< 2: the name of what an INSERT inserts
  std::array<double, 60> number{};  ///< the last value of codes 10 .. 59
  int flags = 0;                    ///< 70
  int degree = 3;                   ///< 71
  int columns = 1;                  ///< 70 of an INSERT
  int rows = 1;                     ///< 71 of an INSERT
  bool invisible = false;           ///< 60 = 1
  bool on_sheet = false;            ///< 67 = 1: on the printed sheet, not in the drawing
  bool tilted = false;              ///< extruded neither up nor down
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

/// A block's entities as they stand in the file, read again for each INSERT.
struct Block {
  std::string_view entities;
  std::size_t line = 0;
  Vec2 base = Vec2::Zero();
  bool elsewhere = false;  ///< an external reference
};

using Affine = Eigen::Affine2d;

/// Adds one group to the entity under construction; false when a number cannot be read.
bool absorb(Entity& e, const Group& g) {
  if (g.code == 2 && e.kind == "INSERT") e.block = g.value;
  const bool wanted = (g.code >= 10 && g.code <= 60) || g.code == 67 || g.code == 70 || g.code == 71 ||
                      (g.code >= 210 && g.code <= 230);
  if (!wanted) return true;
  std::string_view text = g.value;
  const auto value = take_number(text);
  if (!value) return false;
  if (g.code == 60) e.invisible = *value != 0.0;
  if (g.code == 67) e.on_sheet = *value != 0.0;
  if (g.code == 70) e.flags = static_cast<int>(std::clamp(*value, -32768.0, 65535.0));
  if (g.code == 71) e.degree = static_cast<int>(std::clamp(*value, 0.0, 100.0));
  if (g.code == 70) e.columns = static_cast<int>(std::clamp(*value, 1.0, 1e6));
  if (g.code == 71) e.rows = static_cast<int>(std::clamp(*value, 1.0, 1e6));
  if (g.code == 210 || g.code == 220) e.tilted = e.tilted || std::abs(*value) > 1e-9;
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

/// What draws nothing of its own: windows onto the drawing, and marks of where something ends.
bool draws_nothing(const Entity& e) {
  return e.invisible || e.kind == "VIEWPORT" || e.kind == "SEQEND" || e.kind == "ATTDEF";
}

class Reader {
 public:
  explicit Reader(const VectorLimits& limits) : limits_(limits), room_(limits.most_points) {}

  std::vector<geometry::Polyline> lines;
  LeftOut left_out;
  std::string complaint;
  double metres = 1e-3;
  std::map<std::string_view, Block> blocks;

  /// Draws what a section or a block holds.
  void entities(std::string_view text, std::size_t first_line, const Affine& here) {
    Groups groups(text, first_line);
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
    while (complaint.empty()) {
      const auto group = groups.next();
      if (!group) break;
      if (++groups_read_ > most_groups()) return fail("blocks are inserted too often to be drawn");
      if (group->code == 0) {
        flush();
        entity = started(group->value);
      } else if (entity && !absorb(*entity, *group)) {
        return fail(
            fmt::format("line {}: \"{:.40}\" is not a finite number", groups.line_number(), group->value));
      }
    }
    flush();
    if (polyline) draw(*polyline, here);
  }

 private:
  static Entity started(std::string_view kind) {
    Entity e;
    e.kind = std::string(kind.substr(0, 32));
    if (e.kind == "INSERT") e.number[41] = e.number[42] = 1.0;
    return e;
  }

  /// Reading a file of that size without blocks takes about as long.
  std::size_t most_groups() const { return limits_.most_bytes / 4; }

  void draw(const Entity& e, const Affine& outer) {
    if (!complaint.empty() || draws_nothing(e)) return;
    if (e.on_sheet) return left_out.add(e.kind + " on a sheet");
    if (e.tilted) return left_out.add("tilted " + e.kind);
    Affine here = outer;
    // These are given in coordinates of their own plane, the others in those of the drawing.
    for (const std::string_view planar : {"CIRCLE", "ARC", "LWPOLYLINE", "POLYLINE", "INSERT"}) {
      if (e.extruded_down && e.kind == planar) here.scale(Vec2(-1.0, 1.0));
    }
    if (e.kind == "INSERT") return insert(e, here);
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(here.linear());
    const double magnification = svd.singularValues()[0] * metres;
    if (!std::isfinite(magnification)) return fail("a block's scale is not finite");
    if (!(magnification > 0.0)) return;
    CurveWriter w(limits_.chord_error_m / magnification, room_);
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
      if (e.kind == "POLYLINE" && (e.flags & ~(1 | 128)) != 0) return left_out.add("fitted or 3D POLYLINE");
      closed = (e.flags & 1) != 0;
      polyline(e, w, closed);
    } else if (e.kind == "SPLINE") {
      if (!spline(e, w, limits_.chord_error_m / magnification)) return;
      closed = (e.flags & 1) != 0;
    } else {
      return left_out.add(e.kind);
    }
    finish(w, closed, here);
  }

  void insert(const Entity& e, const Affine& here) {
    const auto found = blocks.find(e.block);
    if (found == blocks.end())
      return fail(fmt::format("INSERT of block \"{:.40}\", which the file does not define", e.block));
    const Block& block = found->second;
    if (block.elsewhere)
      return fail(
          fmt::format("block \"{:.40}\" is in another file; bind it into the drawing first", e.block));
    if (++depth_ > kDeepest)
      return fail(fmt::format("block \"{:.40}\" is nested too deeply or in itself", e.block));
    const double angle = e.number[50] * M_PI / 180.0;
    for (int row = 0; row < e.rows && complaint.empty(); ++row) {
      for (int column = 0; column < e.columns && complaint.empty(); ++column) {
        if (++groups_read_ > most_groups()) return fail("blocks are inserted too often to be drawn");
        Affine place = here;
        place.translate(Vec2(e.number[10], e.number[20]))
            .rotate(angle)
            .translate(Vec2(column * e.number[44], row * e.number[45]))
            .scale(Vec2(e.number[41], e.number[42]))
            .translate(-block.base);
        entities(block.entities, block.line, place);
      }
    }
    --depth_;
  }

  static double turn_between(double from, double to) {
    double sweep = std::fmod(to - from, 2.0 * M_PI);
    if (sweep <= 1e-12) sweep += 2.0 * M_PI;
    return sweep;
  }

  void fail(std::string sentence) {
    if (complaint.empty()) complaint = std::move(sentence);
  }

  void finish(CurveWriter& w, bool closed, const Affine& here) {
    if (w.bad()) return fail("a coordinate is not a finite number");
    if (w.full()) return fail(fmt::format("the drawing has more than {} points", limits_.most_points));
    geometry::Polyline line{w.take(), closed};
    room_ -= std::min(room_, line.size());
    for (Vec2& p : line.points_m) p = metres * (here * p);
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

  bool spline(const Entity& e, CurveWriter& w, double chord_error) {
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
      const double steps = std::clamp(std::ceil(std::sqrt(gain * bend / (8.0 * chord_error))), 1.0, 1e6);
      for (double i = 1.0; i <= steps && !w.full() && !w.bad(); i += 1.0) {
        w.line_to(spline_point(e, from + (to - from) * i / steps, span));
      }
    }
    return true;
  }

  static constexpr int kDeepest = 32;

  const VectorLimits& limits_;
  std::size_t room_;
  std::size_t groups_read_ = 0;
  int depth_ = 0;  ///< of blocks within blocks
};

/// Where the file's parts are, and its unit.
struct Contents {
  std::vector<Block> drawn;  ///< sections of entities
  bool any_section = false;
};

/// The first reading; the error is one sentence.
tl::expected<Contents, std::string> contents_of(std::string_view text, Reader& reader) {
  Groups groups(text);
  Contents out;
  std::string_view section;
  std::string_view variable;
  std::string_view block_name;
  Block block;
  bool in_block_head = false;
  std::string_view before = text;  // from the group in hand
  std::size_t line = 0;
  const auto close = [&](Block& part) {
    part.entities = part.entities.substr(0, part.entities.size() - before.size());
  };
  for (; const auto group = groups.next(); before = groups.rest(), line = groups.line_number()) {
    const auto begin = [&] { return Block{before, line}; };
    const bool section_ends = group->value == "SECTION" || group->value == "ENDSEC" || group->value == "EOF";
    if (group->code == 0 && section_ends) {
      if (section == "ENTITIES") close(out.drawn.back());
      section = {};
      out.any_section = true;
      if (group->value == "EOF") break;
    } else if (group->code == 2 && section.empty()) {
      section = group->value;
      if (section == "ENTITIES") out.drawn.push_back({groups.rest(), groups.line_number()});
    } else if (section == "BLOCKS") {
      if (group->code == 0) {
        if (in_block_head) {
          const Block head = block;
          block = begin();
          block.base = head.base;
          block.elsewhere = head.elsewhere;
        }
        in_block_head = group->value == "BLOCK";
        if (in_block_head) {
          block = {};
          block_name = {};
        }
        if (group->value == "ENDBLK") {
          close(block);
          reader.blocks.emplace(block_name, block);
        }
      } else if (in_block_head) {
        std::string_view digits = group->value;
        if (group->code == 2) block_name = group->value;
        if (group->code == 10) block.base.x() = take_number(digits).value_or(NAN);
        if (group->code == 20) block.base.y() = take_number(digits).value_or(NAN);
        if (group->code == 70)
          block.elsewhere = (std::lround(take_number(digits).value_or(0.0)) & (4 | 8)) != 0;
      }
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
    }
  }
  if (groups.damaged)
    return tl::unexpected(fmt::format("not a DXF file, or damaged, near line {}", groups.line_number()));
  return out;
}

}  // namespace

tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.most_bytes) {
    return tl::unexpected(fmt::format("the DXF file is larger than {} MB", limits.most_bytes / 1000000));
  }
  if (text.substr(0, 18) == "AutoCAD Binary DXF") {
    return tl::unexpected<std::string>("binary DXF is not read; save the drawing as ASCII DXF");
  }
  Reader reader(limits);
  const auto contents = contents_of(text, reader);
  if (!contents) return tl::unexpected(contents.error());
  for (const Block& section : contents->drawn) {
    reader.entities(section.entities, section.line, Affine::Identity());
  }
  if (!reader.complaint.empty()) return tl::unexpected(reader.complaint);
  VectorDrawing out;
  out.contours = joined(std::move(reader.lines), 1e-8);
  out.left_out = std::move(reader.left_out);
  if (!out.contours.empty()) return out;
  if (!contents->any_section) return tl::unexpected<std::string>("not a DXF file");
  return tl::unexpected(out.left_out.empty()
                            ? std::string("the DXF file draws no line")
                            : fmt::format("the DXF file draws no line that is understood (not followed: {})",
                                          out.left_out.sentence()));
}

}  // namespace telekerf::vision
