// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/document.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/svg/lengths.h"
#include "common/vision/vector/svg/page.h"
#include "common/vision/vector/svg/shapes.h"
#include "common/vision/vector/svg/style.h"
#include "common/vision/vector/svg/transform.h"
#include "common/vision/vector/svg/view_box.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;
constexpr int kMaxDepth = 100;

class SvgReader {
 public:
  SvgReader(const tinyxml2::XMLElement& root, const SvgPage& page, const VectorLimits& limits)
      : max_elements_(limits.max_points), viewport_(page.units), out_(limits, {page.metres, -page.metres}) {
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
    if (depth > kMaxDepth) return out_.fail("groups are nested too deeply");
    if (++visited_ > max_elements_)
      return out_.fail(fmt::format("the drawing has more than {} elements", max_elements_));
    const std::string_view name = local_name(e.Name());
    if (draws_nothing(e, name) || is_hidden(e)) return;
    note_effects(e, out_);
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
      here.translate(position_of(e));
      return viewport(e, here, extent_of(e, e), depth);
    }
    draw_shape(name, e, coordinates(e), here, out_);
  }

  static std::string_view local_name(std::string_view name) {
    const auto colon = name.rfind(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
  }

  void find_names(const tinyxml2::XMLElement& e, int depth) {
    if (const char* id = e.Attribute("id")) named_.emplace(id, &e);
    if (depth > kMaxDepth) return;
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      find_names(*child, depth + 1);
    }
  }

  /// Definitions, descriptions and what editors note for themselves.
  bool draws_nothing(const tinyxml2::XMLElement& e, std::string_view name) {
    if (name == "style") {
      note_style_sheet(e, out_);
      return true;
    }
    constexpr std::array<std::string_view, 14> kSilent{
        "defs",           "clipPath", "mask",     "symbol", "pattern", "marker", "linearGradient",
        "radialGradient", "filter",   "metadata", "title",  "desc",    "script", "view"};
    if (std::find(kSilent.begin(), kSilent.end(), name) != kSilent.end()) return true;
    const std::string_view whole(e.Name());
    return whole.size() > name.size() && whole.substr(0, 4) != "svg:";
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
    if (link == nullptr) return out_.unsupported.add("use");  // SVG: it draws nothing
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
    here.translate(position_of(e));
    const std::string_view kind = local_name(target->Name());
    if ((kind == "symbol" || kind == "svg") && !is_hidden(*target)) {
      if (target->Attribute("transform") != nullptr)
        out_.unsupported.add(fmt::format("transform of a {}", kind));
      viewport(*target, here, extent_of(e, *target), depth);
    } else {
      element(*target, here, depth + 1);
    }
    in_use_.pop_back();
  }

  SvgCoordinates coordinates(const tinyxml2::XMLElement& e) { return {e, viewport_, out_}; }

  Vec2 position_of(const tinyxml2::XMLElement& e) {
    const SvgCoordinates at = coordinates(e);
    return Vec2(at("x"), at("y"));
  }

  /// Width and height of a nested viewport: those of the `use` count first, all there is where none is given.
  Vec2 extent_of(const tinyxml2::XMLElement& use, const tinyxml2::XMLElement& target) {
    const auto along = [&](const char* name, double all) {
      const double own = coordinates(target)(name, all);
      return coordinates(use)(name, own);
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

  std::size_t max_elements_;
  std::size_t visited_ = 0;
  Vec2 viewport_;
  std::map<std::string_view, const tinyxml2::XMLElement*> named_;
  std::vector<const tinyxml2::XMLElement*> in_use_;
  DrawnLines out_;
};

}  // namespace

tl::expected<VectorDrawing, std::string> read_svg(std::string_view text, const VectorLimits& limits) {
  if (text.size() > limits.max_bytes) {
    return tl::unexpected(fmt::format("the SVG file is larger than {} MB", limits.max_bytes / 1000000));
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
  SvgReader reader(*root, *page, limits);
  reader.children(*root, page->view, 0);
  auto out = reader.drawing();
  if (!out) return out;
  out->page_width_m = page->size_m.x();
  out->page_height_m = page->size_m.y();
  return out;
}

}  // namespace telekerf::vision
