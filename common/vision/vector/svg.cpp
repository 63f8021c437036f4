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

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/number.h"
#include "common/vision/vector/svg_path.h"
#include "common/vision/vector/svg_transform.h"
#include "common/vision/vector/vector_drawing.h"

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

/// A length of the page itself; nothing where it is left to the viewer (no length, auto, a per cent). What is
/// no length is refused, since the drawing would then come out in some other size than meant.
tl::expected<std::optional<double>, std::string> page_length_of(const tinyxml2::XMLElement& root,
                                                                const char* name) {
  const char* text = root.Attribute(name);
  if (text == nullptr || std::strcmp(text, "auto") == 0 || std::strchr(text, '%') != nullptr)
    return std::nullopt;
  const auto length_m = length_of(text);
  if (length_m && *length_m > 0.0) return length_m;
  return tl::unexpected(
      fmt::format("{} = \"{:.30}\" is no length above 0; write it like \"100.5mm\"", name, text));
}

/// Nothing where the element has none.
tl::expected<std::optional<ViewBox>, std::string> view_box_of(const tinyxml2::XMLElement& e) {
  const char* text = e.Attribute("viewBox");
  if (text == nullptr) return std::nullopt;
  const auto box = read_view_box(text);
  if (!box) return tl::unexpected(box.error());
  return *box;
}

std::string_view aspect_of(const tinyxml2::XMLElement& e) {
  const char* text = e.Attribute("preserveAspectRatio");
  return text != nullptr ? text : "xMidYMid";
}

/// The outermost viewport.
struct Page {
  Vec2 size_m = Vec2::Zero();  ///< 0: the file does not say
  double metres = kPixel;      ///< a user unit, along the axis that is magnified less
  Vec2 units = Vec2::Zero();   ///< its size in user units
  Affine view = Affine::Identity();
};

tl::expected<Page, std::string> page_of(const tinyxml2::XMLElement& root) {
  const auto width = page_length_of(root, "width");
  if (!width) return tl::unexpected(width.error());
  const auto height = page_length_of(root, "height");
  if (!height) return tl::unexpected(height.error());
  const auto box = view_box_of(root);
  if (!box) return tl::unexpected(box.error());
  Page out;
  out.size_m = {width->value_or(0.0), height->value_or(0.0)};
  if (*box) {
    Vec2 scale = Vec2::Constant(kPixel);
    if (*width && *height) {
      scale = scale_of(**box, out.size_m, aspect_of(root));
    } else if (*width || *height) {
      scale.setConstant(*width ? **width / (*box)->size.x() : **height / (*box)->size.y());
    }
    out.metres = scale.minCoeff();
    // Contours are centred later: where the viewport puts the box does not count.
    if (out.metres > 0.0) out.view.scale(scale / out.metres);
    out.view.translate(-(*box)->corner);
    out.size_m = (*box)->size.cwiseProduct(scale);
  }
  if (!(out.metres > 0.0) || !std::isfinite(out.metres))
    return tl::unexpected<std::string>("the drawing's size is not positive");
  out.units = *box ? (*box)->size : Vec2(out.size_m / out.metres);
  return out;
}

class Reader {
 public:
  Reader(const tinyxml2::XMLElement& root, const Page& page, const VectorLimits& limits)
      : most_elements_(limits.most_points), viewport_(page.units), out_(limits, {page.metres, -page.metres}) {
    find_names(root, 0);
  }

  tl::expected<VectorDrawing, std::string> drawing() { return out_.drawing("SVG"); }

  void children(const tinyxml2::XMLElement& e, const Affine& here, int depth) {
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      element(*child, here, depth + 1);
    }
  }

 private:
  void element(const tinyxml2::XMLElement& e, const Affine& outer, int depth) {
    if (out_.failed()) return;
    if (depth > kDeepest) return out_.fail("groups are nested too deeply");
    if (++visited_ > most_elements_)
      return out_.fail(fmt::format("the drawing has more than {} elements", most_elements_));
    const std::string_view name = local_name(e.Name());
    if (draws_nothing(e, name) || is_hidden(e)) return;
    note_effects(e);
    Affine here = outer;
    if (const char* text = e.Attribute("transform")) {
      const auto transform = transform_of(text);
      if (!transform) return out_.fail(fmt::format("transform \"{:.60}\" cannot be read", text));
      here = outer * *transform;
      if (!here.matrix().allFinite()) return out_.fail("a transform is not finite");
    }
    if (name == "g" || name == "a") return children(e, here, depth);
    if (name == "switch") return first_choice(e, here, depth);
    if (name == "use") return use(e, here, depth);
    if (name == "svg") {
      here.translate(Vec2(coordinate(e, "x"), coordinate(e, "y")));
      return viewport(e, here, extent_of(e, e), depth);
    }
    auto writer = out_.writer(here);
    if (writer) shape(name, e, *writer, here);
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
        if (sheet.find(rule) != std::string_view::npos) out_.left_out.add("rules of a style sheet");
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
      if (has || flat.find(fmt::format(";{}:url", name)) != std::string::npos) out_.left_out.add(name);
    }
    if (flat.find(";transform:") != std::string::npos)
      out_.fail("a transform within a style is not read; write it as the element's own transform");
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
    if (link == nullptr) return out_.left_out.add("use");  // SVG: it draws nothing
    if (link[0] != '#')
      return out_.fail(
          fmt::format("use of \"{:.60}\": only what the same file defines (#name) is followed", link));
    const auto found = named_.find(std::string_view(link + 1));
    if (found == named_.end())
      return out_.fail(fmt::format("use of \"{:.60}\", which the file does not define", link));
    const tinyxml2::XMLElement* target = found->second;
    if (std::find(in_use_.begin(), in_use_.end(), target) != in_use_.end())
      return out_.fail(fmt::format("use of \"{:.60}\" within itself", link));
    in_use_.push_back(target);
    here.translate(Vec2(coordinate(e, "x"), coordinate(e, "y")));
    const std::string_view kind = local_name(target->Name());
    if ((kind == "symbol" || kind == "svg") && !is_hidden(*target)) {
      if (target->Attribute("transform") != nullptr)
        out_.left_out.add(fmt::format("transform of a {}", kind));
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
    const auto box = view_box_of(e);
    if (!box) return out_.fail(box.error());
    if (*box && !(size.minCoeff() > 0.0)) return out_.fail("a viewBox is shown in no area");
    viewport_ = *box ? (*box)->size : size;
    children(e, *box ? here * fitted(**box, size, aspect_of(e)) : here, depth);
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
      out_.fail(fmt::format("{} = \"{:.30}\" is not a length that is understood", name, text));
      return fallback;
    }
    const std::string_view axis(name);
    if (axis == "width" || axis.find('x') != std::string_view::npos) return 0.01 * *share * viewport_.x();
    if (axis == "height" || axis.find('y') != std::string_view::npos) return 0.01 * *share * viewport_.y();
    return 0.01 * *share * viewport_.norm() / std::sqrt(2.0);
  }

  void shape(std::string_view name, const tinyxml2::XMLElement& e, CurveWriter& w, const Affine& here) {
    if (name == "path") {
      if (const char* d = e.Attribute("d")) path(d, w, here);
    } else if (name == "line") {
      w.move_to({coordinate(e, "x1"), coordinate(e, "y1")});
      w.line_to({coordinate(e, "x2"), coordinate(e, "y2")});
      out_.add(w, here, false);
    } else if (name == "polyline" || name == "polygon") {
      std::string_view text = e.Attribute("points") != nullptr ? e.Attribute("points") : "";
      bool first = true;
      while (auto x = take_number(text)) {
        const auto y = take_number(text);
        if (!y) return out_.fail("a polyline has an odd number of coordinates");
        first ? w.move_to({*x, *y}) : w.line_to({*x, *y});
        first = false;
        if (w.full() || w.bad()) break;
      }
      skip_separators(text);
      if (!text.empty() && !w.full() && !w.bad()) return out_.fail("a polyline's points cannot be read");
      out_.add(w, here, name == "polygon");
    } else if (name == "rect") {
      rectangle(e, w, here);
    } else if (name == "circle" || name == "ellipse") {
      const double r = coordinate(e, "r");
      const Vec2 radii = name == "circle" ? Vec2(r, r) : Vec2(coordinate(e, "rx"), coordinate(e, "ry"));
      if (!(radii.minCoeff() > 0.0)) return;
      w.ellipse({coordinate(e, "cx"), coordinate(e, "cy")}, {radii.x(), 0}, {0, radii.y()}, 0.0, 2.0 * M_PI);
      out_.add(w, here, true);
    } else {
      out_.left_out.add(name);
    }
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
    out_.add(w, here, true);
  }

  void path(std::string_view d, CurveWriter& w, const Affine& here) {
    const auto end_subpath = [&](bool closed) {
      if (w.points().size() > 1) {
        out_.add(w, here, closed);
      } else {
        w.take();
      }
    };
    PathData data(d);
    while (const auto segment = data.next()) {
      if (segment->kind == PathSegment::Kind::kMove || segment->kind == PathSegment::Kind::kClose) {
        end_subpath(segment->kind == PathSegment::Kind::kClose);
        if (out_.failed()) return;
        if (segment->kind == PathSegment::Kind::kMove) w.move_to(segment->to);
        continue;
      }
      if (w.points().empty()) w.move_to(segment->from);  // drawing goes on after a close
      draw(*segment, w);
      if (w.full() || w.bad()) return out_.add(w, here, false);
    }
    if (data.damaged())
      return out_.fail(fmt::format("a path's data cannot be read near \"{:.30}\"", data.rest()));
    end_subpath(false);
  }

  std::size_t most_elements_;
  std::size_t visited_ = 0;
  Vec2 viewport_;
  std::map<std::string_view, const tinyxml2::XMLElement*> named_;
  std::vector<const tinyxml2::XMLElement*> in_use_;
  DrawnLines out_;
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
  const auto page = page_of(*root);
  if (!page) return tl::unexpected(page.error());
  Reader reader(*root, *page, limits);
  reader.children(*root, page->view, 0);
  auto out = reader.drawing();
  if (!out) return out;
  out->page_width_m = page->size_m.x();
  out->page_height_m = page->size_m.y();
  return out;
}

}  // namespace telekerf::vision
