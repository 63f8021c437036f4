// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "common/vision/curves.h"
#include "common/vision/number.h"
#include "common/vision/svg_path.h"
#include "common/vision/svg_transform.h"
#include "common/vision/vector_drawing.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;
constexpr double kPixel = 25.4e-3 / 96.0;  ///< CSS: metres in a pixel
constexpr int kDeepest = 100;

/// Metres in a length like "20mm"; a per cent or an unknown unit is nothing.
std::optional<double> length_of(const char* text) {
  if (text == nullptr) return std::nullopt;
  std::string_view rest(text);
  const auto value = take_number(rest);
  if (!value) return std::nullopt;
  while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.back())) != 0) rest.remove_suffix(1);
  constexpr std::array<std::pair<std::string_view, double>, 8> kUnits{{{"", kPixel},
                                                                       {"px", kPixel},
                                                                       {"mm", 1e-3},
                                                                       {"cm", 1e-2},
                                                                       {"m", 1.0},
                                                                       {"in", 25.4e-3},
                                                                       {"pt", 25.4e-3 / 72.0},
                                                                       {"pc", 25.4e-3 / 6.0}}};
  for (const auto& [name, metres] : kUnits) {
    if (rest == name) return *value * metres;
  }
  return std::nullopt;
}

/// A length of the page itself; nothing where it is left to the viewer (no length, auto, a per cent),
/// `complaint` where it is no length, since the drawing would then come out in some other size than meant.
std::optional<double> page_length_of(const tinyxml2::XMLElement& root, const char* name,
                                     std::string& complaint) {
  const char* text = root.Attribute(name);
  if (text == nullptr || std::strcmp(text, "auto") == 0 || std::strchr(text, '%') != nullptr)
    return std::nullopt;
  const auto length_m = length_of(text);
  if (!length_m || !(*length_m > 0.0)) {
    complaint = fmt::format("{} = \"{:.30}\" is no length above 0; write it like \"100.5mm\"", name, text);
    return std::nullopt;
  }
  return length_m;
}

/// Nothing where the element has none; `complaint` where it has one that cannot be used.
std::optional<ViewBox> view_box_of(const tinyxml2::XMLElement& e, std::string& complaint) {
  const char* text = e.Attribute("viewBox");
  if (text == nullptr) return std::nullopt;
  const auto box = read_view_box(text);
  if (box) return *box;
  complaint = box.error();
  return std::nullopt;
}

std::string_view aspect_of(const tinyxml2::XMLElement& e) {
  const char* text = e.Attribute("preserveAspectRatio");
  return text != nullptr ? text : "xMidYMid";
}

class Reader {
 public:
  /// `page` is the outermost viewport, in user units.
  Reader(const tinyxml2::XMLElement& root, const VectorLimits& limits, double metres_per_unit,
         const Vec2& page)
      : metres_(metres_per_unit), limits_(limits), room_(limits.most_points), viewport_(page) {
    find_names(root, 0);
  }

  std::vector<geometry::Polyline> lines;
  LeftOut left_out;
  std::string complaint;

  void children(const tinyxml2::XMLElement& e, const Affine& here, int depth) {
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      element(*child, here, depth + 1);
    }
  }

 private:
  void element(const tinyxml2::XMLElement& e, const Affine& outer, int depth) {
    if (!complaint.empty()) return;
    if (depth > kDeepest) return fail("groups are nested too deeply");
    if (++visited_ > limits_.most_points)
      return fail(fmt::format("the drawing has more than {} elements", limits_.most_points));
    const std::string_view name = local_name(e.Name());
    if (draws_nothing(e, name) || is_hidden(e)) return;
    note_effects(e);
    Affine here = outer;
    if (const char* text = e.Attribute("transform")) {
      const auto transform = transform_of(text);
      if (!transform) return fail(fmt::format("transform \"{:.60}\" cannot be read", text));
      here = outer * *transform;
      if (!here.matrix().allFinite()) return fail("a transform is not finite");
    }
    if (name == "g" || name == "a") return children(e, here, depth);
    if (name == "switch") return first_choice(e, here, depth);
    if (name == "use") return use(e, here, depth);
    if (name == "svg") {
      here.translate(Vec2(coordinate(e, "x"), coordinate(e, "y")));
      return viewport(e, here, extent_of(e, e), depth);
    }
    // Curves are cut in the element's own units, as finely as its largest magnification asks for.
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(here.linear());
    const double magnification = svd.singularValues()[0] * metres_;
    if (!(magnification > 0.0) || !std::isfinite(magnification)) return;
    CurveWriter writer(limits_.chord_error_m / magnification, room_);
    shape(name, e, writer, here);
  }

  static std::string_view local_name(std::string_view name) {
    const auto colon = name.rfind(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
  }

  void find_names(const tinyxml2::XMLElement& e, int depth) {
    if (const char* id = e.Attribute("id")) named_.emplace(id, &e);
    if (depth > kDeepest) return;
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      find_names(*child, depth + 1);
    }
  }

  /// Definitions, descriptions and what editors note for themselves.
  bool draws_nothing(const tinyxml2::XMLElement& e, std::string_view name) {
    if (name == "style") {
      const char* text = e.GetText();
      const std::string_view sheet = text != nullptr ? text : "";
      for (const std::string_view rule : {"display", "visibility", "transform"}) {
        if (sheet.find(rule) != std::string_view::npos) left_out.add("rules of a style sheet");
      }
      return true;
    }
    constexpr std::array<std::string_view, 14> kSilent{
        "defs",           "clipPath", "mask",     "symbol", "pattern", "marker", "linearGradient",
        "radialGradient", "filter",   "metadata", "title",  "desc",    "script", "view"};
    if (std::find(kSilent.begin(), kSilent.end(), name) != kSilent.end()) return true;
    const std::string_view whole(e.Name());
    return whole.size() > name.size() && whole.substr(0, 4) != "svg:";
  }

  static std::string flat_style(const tinyxml2::XMLElement& e) {
    const char* style = e.Attribute("style");
    std::string flat(1, ';');
    for (const char* c = style; c != nullptr && *c != 0 && flat.size() < 4096; ++c) {
      if (std::isspace(static_cast<unsigned char>(*c)) == 0) flat.push_back(*c);
    }
    return flat;
  }

  static bool is_hidden(const tinyxml2::XMLElement& e) {
    const auto is = [&](const char* name, const char* value) {
      const char* text = e.Attribute(name);
      return text != nullptr && std::strcmp(text, value) == 0;
    };
    if (is("display", "none") || is("visibility", "hidden")) return true;
    const std::string flat = flat_style(e);
    return flat.find("display:none") != std::string::npos ||
           flat.find("visibility:hidden") != std::string::npos;
  }

  /// What changes the picture of an element that is followed all the same.
  void note_effects(const tinyxml2::XMLElement& e) {
    const std::string flat = flat_style(e);
    for (const char* name : {"clip-path", "mask", "marker", "marker-start", "marker-mid", "marker-end"}) {
      const char* text = e.Attribute(name);
      const bool has = text != nullptr && std::strcmp(text, "none") != 0;
      if (has || flat.find(fmt::format(";{}:url", name)) != std::string::npos) left_out.add(name);
    }
    if (flat.find(";transform:") != std::string::npos)
      fail("a transform within a style is not read; write it as the element's own transform");
  }

  /// The first child that asks for no extension.
  void first_choice(const tinyxml2::XMLElement& e, const Affine& here, int depth) {
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      if (child->Attribute("requiredExtensions") == nullptr) return element(*child, here, depth + 1);
    }
  }

  /// Draws what is defined elsewhere in the file.
  void use(const tinyxml2::XMLElement& e, Affine here, int depth) {
    const char* link = nullptr;
    for (auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
      if (local_name(a->Name()) == "href") link = a->Value();
    }
    if (link == nullptr) return left_out.add("use");  // SVG: it draws nothing
    if (link[0] != '#')
      return fail(
          fmt::format("use of \"{:.60}\": only what the same file defines (#name) is followed", link));
    const auto found = named_.find(std::string_view(link + 1));
    if (found == named_.end())
      return fail(fmt::format("use of \"{:.60}\", which the file does not define", link));
    const tinyxml2::XMLElement* target = found->second;
    if (std::find(in_use_.begin(), in_use_.end(), target) != in_use_.end())
      return fail(fmt::format("use of \"{:.60}\" within itself", link));
    in_use_.push_back(target);
    here.translate(Vec2(coordinate(e, "x"), coordinate(e, "y")));
    const std::string_view kind = local_name(target->Name());
    if ((kind == "symbol" || kind == "svg") && !is_hidden(*target)) {
      if (target->Attribute("transform") != nullptr) left_out.add(fmt::format("transform of a {}", kind));
      viewport(*target, here, extent_of(e, *target), depth);
    } else {
      element(*target, here, depth + 1);
    }
    in_use_.pop_back();
  }

  /// Width and height of a nested viewport: those of the `use` count first, all there is where none is given.
  Vec2 extent_of(const tinyxml2::XMLElement& use, const tinyxml2::XMLElement& target) {
    const auto along = [&](const char* name, double all) {
      const double own = coordinate(target, name, all);
      return coordinate(use, name, own);
    };
    return {along("width", viewport_.x()), along("height", viewport_.y())};
  }

  void viewport(const tinyxml2::XMLElement& e, const Affine& here, const Vec2& size, int depth) {
    const Vec2 around = viewport_;
    const auto box = view_box_of(e, complaint);
    viewport_ = box ? box->size : size;
    if (box && !(size.minCoeff() > 0.0)) fail("a viewBox is shown in no area");
    if (complaint.empty()) children(e, box ? here * fitted(*box, size, aspect_of(e)) : here, depth);
    viewport_ = around;
  }

  /// A coordinate in user units; units of length are turned into pixels, per cents are of the viewport.
  double coordinate(const tinyxml2::XMLElement& e, const char* name, double fallback = 0.0) {
    const char* text = e.Attribute(name);
    if (text == nullptr || std::strcmp(text, "auto") == 0) return fallback;
    if (const auto metres = length_of(text)) return *metres / kPixel;
    std::string_view rest(text);
    const auto share = take_number(rest);
    if (!share || rest != "%") {
      fail(fmt::format("{} = \"{:.30}\" is not a length that is understood", name, text));
      return fallback;
    }
    const std::string_view axis(name);
    if (axis == "width" || axis.find('x') != std::string_view::npos) return 0.01 * *share * viewport_.x();
    if (axis == "height" || axis.find('y') != std::string_view::npos) return 0.01 * *share * viewport_.y();
    return 0.01 * *share * viewport_.norm() / std::sqrt(2.0);
  }

  void fail(std::string sentence) {
    if (complaint.empty()) complaint = std::move(sentence);
  }

  void finish(CurveWriter& writer, const Affine& here, bool closed) {
    if (writer.bad()) return fail("a coordinate is not a finite number");
    if (writer.full()) return fail(fmt::format("the drawing has more than {} points", limits_.most_points));
    geometry::Polyline line{writer.take(), closed};
    room_ -= std::min(room_, line.size());
    for (Vec2& p : line.points_m) {
      p = here * p;
      p = metres_ * Vec2(p.x(), -p.y());
    }
    if (!geometry::all_finite(line.points_m)) return fail("a coordinate is not a finite number");
    line = geometry::without_duplicates(line);
    if (line.size() >= 2) lines.push_back(std::move(line));
  }

  void shape(std::string_view name, const tinyxml2::XMLElement& e, CurveWriter& w, const Affine& here) {
    if (name == "path") {
      if (const char* d = e.Attribute("d")) path(d, w, here);
    } else if (name == "line") {
      w.move_to({coordinate(e, "x1"), coordinate(e, "y1")});
      w.line_to({coordinate(e, "x2"), coordinate(e, "y2")});
      finish(w, here, false);
    } else if (name == "polyline" || name == "polygon") {
      std::string_view text = e.Attribute("points") != nullptr ? e.Attribute("points") : "";
      bool first = true;
      while (auto x = take_number(text)) {
        const auto y = take_number(text);
        if (!y) return fail("a polyline has an odd number of coordinates");
        first ? w.move_to({*x, *y}) : w.line_to({*x, *y});
        first = false;
        if (w.full() || w.bad()) break;
      }
      skip_separators(text);
      if (!text.empty() && !w.full() && !w.bad()) return fail("a polyline's points cannot be read");
      finish(w, here, name == "polygon");
    } else if (name == "rect") {
      rectangle(e, w, here);
    } else if (name == "circle" || name == "ellipse") {
      const double r = coordinate(e, "r");
      const Vec2 radii = name == "circle" ? Vec2(r, r) : Vec2(coordinate(e, "rx"), coordinate(e, "ry"));
      if (!(radii.minCoeff() > 0.0)) return;
      w.ellipse({coordinate(e, "cx"), coordinate(e, "cy")}, {radii.x(), 0}, {0, radii.y()}, 0.0, 2.0 * M_PI);
      drop_last(w, here);
    } else {
      left_out.add(name);
    }
  }

  /// A full turn ends where it began; the closed polyline does not repeat that point.
  void drop_last(CurveWriter& w, const Affine& here) {
    CurveWriter copy = w;
    std::vector<Vec2> points = copy.take();
    if (points.size() > 1 && !w.full() && !w.bad()) {
      points.pop_back();
      CurveWriter again(1.0, points.size());
      for (std::size_t i = 0; i < points.size(); ++i)
        i == 0 ? again.move_to(points[i]) : again.line_to(points[i]);
      return finish(again, here, true);
    }
    finish(w, here, true);
  }

  void rectangle(const tinyxml2::XMLElement& e, CurveWriter& w, const Affine& here) {
    const double x = coordinate(e, "x");
    const double y = coordinate(e, "y");
    const double width = coordinate(e, "width");
    const double height = coordinate(e, "height");
    if (!(width > 0.0) || !(height > 0.0)) return;
    double rx = coordinate(e, "rx", coordinate(e, "ry", 0.0));
    double ry = coordinate(e, "ry", rx);
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
    finish(w, here, true);
  }

  void path(std::string_view d, CurveWriter& w, const Affine& here) {
    const auto end_subpath = [&](bool closed) {
      if (w.points().size() > 1) {
        finish(w, here, closed);
      } else {
        w.take();
      }
    };
    PathData data(d);
    while (const auto segment = data.next()) {
      if (segment->kind == PathSegment::Kind::kMove || segment->kind == PathSegment::Kind::kClose) {
        end_subpath(segment->kind == PathSegment::Kind::kClose);
        if (!complaint.empty()) return;
        if (segment->kind == PathSegment::Kind::kMove) w.move_to(segment->to);
        continue;
      }
      if (w.points().empty()) w.move_to(segment->from);  // drawing goes on after a close
      draw(*segment, w);
      if (w.full() || w.bad()) return finish(w, here, false);
    }
    if (data.damaged()) return fail(fmt::format("a path's data cannot be read near \"{:.30}\"", data.rest()));
    end_subpath(false);
  }

  double metres_;
  const VectorLimits& limits_;
  std::size_t room_;
  std::size_t visited_ = 0;
  Vec2 viewport_;
  std::map<std::string_view, const tinyxml2::XMLElement*> named_;
  std::vector<const tinyxml2::XMLElement*> in_use_;
};

}  // namespace

tl::expected<VectorDrawing, std::string> read_svg(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.most_bytes) {
    return tl::unexpected(fmt::format("the SVG file is larger than {} MB", limits.most_bytes / 1000000));
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return tl::unexpected(
        fmt::format("not an SVG file: its XML is damaged in line {}", document.ErrorLineNum()));
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()).find("svg") == std::string_view::npos) {
    return tl::unexpected<std::string>("not an SVG file: its root element is not <svg>");
  }
  if (root->Attribute("transform") != nullptr) {
    return tl::unexpected<std::string>(
        "a transform of the whole <svg> is not read; put it on a group within");
  }
  VectorDrawing out;
  Affine view = Affine::Identity();
  double metres = kPixel;
  std::string complaint;
  const auto width = page_length_of(*root, "width", complaint);
  const auto height = page_length_of(*root, "height", complaint);
  const auto box = view_box_of(*root, complaint);
  if (!complaint.empty()) return tl::unexpected(complaint);
  if (box) {
    // Contours are centred later: only the scale counts.
    Vec2 scale = Vec2::Constant(kPixel);
    if (width && height) {
      scale = scale_of(*box, {*width, *height}, aspect_of(*root));
    } else if (width || height) {
      scale.setConstant(width ? *width / box->size.x() : *height / box->size.y());
    }
    metres = scale.minCoeff();
    if (metres > 0.0) view.scale(scale / metres);
    view.translate(-box->corner);
    out.page_width_m = box->size.x() * scale.x();
    out.page_height_m = box->size.y() * scale.y();
  } else {
    out.page_width_m = width.value_or(0.0);
    out.page_height_m = height.value_or(0.0);
  }
  if (!(metres > 0.0) || !std::isfinite(metres))
    return tl::unexpected<std::string>("the drawing's size is not positive");
  Reader reader(*root, limits, metres,
                box ? box->size : Vec2(out.page_width_m / metres, out.page_height_m / metres));
  reader.children(*root, view, 0);
  if (!reader.complaint.empty()) return tl::unexpected(reader.complaint);
  out.contours = joined(std::move(reader.lines), 1e-8);
  out.left_out = std::move(reader.left_out);
  if (out.contours.empty()) {
    return tl::unexpected(out.left_out.empty() ? std::string("the SVG file draws no line")
                                               : fmt::format("the SVG file draws no line that is understood "
                                                             "(not followed: {})",
                                                             out.left_out.sentence()));
  }
  return out;
}

}  // namespace telekerf::vision
