// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/reader.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/vision/vector/svg/clip.h"
#include "common/vision/vector/svg/shapes.h"
#include "common/vision/vector/svg/transform.h"
#include "common/vision/vector/svg/view_box.h"
#include "common/vision/vector/svg/xml.h"

namespace telekerf::vision {
namespace {

constexpr int kMaxDepth = 600;

/// An attribute by its local name: inkscape:label, whatever its prefix.
const char* attribute(const tinyxml2::XMLElement& e, std::string_view name) {
  for (auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (local_name(a->Name()) == name) return a->Value();
  }
  return nullptr;
}

/// The name in "url(#name)"; empty where there is none.
std::string_view reference(std::string_view text) {
  const auto hash = text.find('#');
  const auto end = text.find_first_of(")\"'", hash);
  if (!text.starts_with("url(") || hash == std::string_view::npos || end == std::string_view::npos) return {};
  return text.substr(hash + 1, end - hash - 1);
}

/// The layer that a group is: an editor's, or a group of the outermost level with a name.
std::string layer_of(const tinyxml2::XMLElement& e, int depth) {
  const char* mode = attribute(e, "groupmode");
  const char* label = attribute(e, "label");
  if (mode != nullptr && std::string_view(mode) == "layer" && label != nullptr) return label;
  const char* id = e.Attribute("id");
  const bool outermost = depth == 1 || (mode != nullptr && std::string_view(mode) == "layer");
  return outermost && id != nullptr ? id : "";
}

/// A style sheet's language; that of others is not for browsers.
bool is_css(const tinyxml2::XMLElement& style) {
  const char* type = style.Attribute("type");
  return type == nullptr || *type == 0 || std::string_view(type) == "text/css";
}

/// What is drawn beyond the rectangle from 0,0 is not seen.
bool clips(const Properties& own) {
  const auto overflow = own.find("overflow");
  return overflow == own.end() || (overflow->second != "visible" && overflow->second != "auto");
}

}  // namespace

SvgReader::SvgReader(const Element& root, const SvgPage& page, const VectorLimits& limits,
                     const VectorRequest& request)
    : root_(root),
      page_(page),
      limits_(limits),
      request_(request),
      viewport_(page.units),
      out_(limits, request, {page.metres, -page.metres}) {
  find_names(root, 0);
}

tl::expected<VectorDrawing, std::string> SvgReader::drawing() {
  if (!cascade_.trouble().empty()) return tl::unexpected(cascade_.trouble());
  const Properties own = cascade_.of(root_);
  if (own.contains("transform"))
    return tl::unexpected<std::string>(
        "a transform of the whole <svg> is not read; put it on a group within");
  if (const auto trouble = trouble_of(own); !trouble.empty()) return tl::unexpected(trouble);
  for (const char* side : {"width", "height"}) {
    const auto styled = own.find(side);
    if (styled == own.end() || styled->second == "auto" || styled->second.find('%') != std::string::npos ||
        root_.Attribute(side, styled->second.c_str()) != nullptr)
      continue;
    return tl::unexpected(fmt::format(
        "the page's {0} in a style, \"{1:.30}\", is not read; write it as the attribute {0} of <svg>", side,
        styled->second));
  }
  children(root_, {page_.view, look_of(own, {}), 0});
  if (dashed_ > 0)
    out_.notes.push_back(fmt::format("{} dashed lines are cut whole (stroke-dasharray)", dashed_));
  return out_.drawing("SVG");
}

void SvgReader::find_names(const Element& e, int depth) {
  if (const char* id = e.Attribute("id")) named_.emplace(id, &e);
  if (svg_name(e) == "style" && is_css(e)) {
    const char* media = e.Attribute("media");
    for (auto* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
      if (node->ToText() == nullptr) continue;
      const std::string sheet = node->Value();
      cascade_.add_sheet(media == nullptr ? sheet : fmt::format("@media {} {{{}}}", media, sheet));
    }
  }
  if (local_name(e.Name()) == "link" && e.Attribute("rel", "stylesheet") != nullptr)
    out_.fail("a style sheet of another file (link) is not read; put its rules into a <style> of this one");
  if (depth > kMaxDepth) return;
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    find_names(*child, depth + 1);
}

const tinyxml2::XMLElement* SvgReader::named(std::string_view id) const {
  const auto found = named_.find(id);
  return found == named_.end() ? nullptr : found->second;
}

void SvgReader::children(const Element& e, const Inherited& inherited) {
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    element(*child, inherited);
}

void SvgReader::element(const Element& e, const Inherited& around) {
  if (out_.failed()) return;
  Inherited self = around;
  if (++self.depth > kMaxDepth) return out_.fail("groups are nested too deeply");
  if (++visited_ > limits_.max_points)
    return out_.fail(fmt::format("the drawing has more than {} elements", limits_.max_points));
  const std::string_view name = svg_name(e);
  if (draws_nothing(name)) return;
  const Properties own = cascade_.of(e);
  self.look = look_of(own, around.look);
  self.look.passed_over = self.look.passed_over || !is_met(e);
  self.look.displayed = self.look.displayed && !self.look.passed_over;
  if (const auto trouble = trouble_of(own); !trouble.empty() && self.look.displayed)
    return out_.fail(trouble);
  if (!transform(own, self.here)) return;
  const std::size_t first = out_.count();
  contents(name, e, own, self);
  if (!out_.failed()) clip(own, self, first);
}

void SvgReader::contents(std::string_view name, const Element& e, const Properties& own,
                         const Inherited& self) {
  if (name == "g" || name == "a") {
    const std::string layer = name == "g" ? layer_of(e, self.depth) : "";
    const std::string before = out_.pen.layer;
    if (!layer.empty()) out_.pen.layer = before.empty() ? layer : before + "/" + layer;
    children(e, self);
    out_.pen.layer = before;
  } else if (name == "switch") {
    first_choice(e, self);
  } else if (name == "use") {
    use(e, own, self);
  } else if (name == "svg") {
    Inherited within = self;
    within.here.translate(position_of(e, own));
    const SvgCoordinates at = coordinates(e, own);
    viewport(e, own, within, {at("width", viewport_.x()), at("height", viewport_.y())});
  } else {
    shape(name, e, own, self);
  }
}

bool SvgReader::transform(const Properties& own, Affine& here) {
  const auto written = own.find("transform");
  if (written == own.end()) return true;
  const auto map = transform_of(written->second);
  if (!map) {
    out_.fail(fmt::format("transform \"{:.60}\" cannot be read", written->second));
    return false;
  }
  Vec2 origin = Vec2::Zero();
  // An origin within the element's own box is its corner even where none is written.
  if (const auto box = own.find("transform-box"); box != own.end() && box->second != "view-box") {
    out_.fail(fmt::format(
        "the transform-origin of a transform-box \"{:.40}\" is not followed; write it into the transform",
        box->second));
    return false;
  }
  if (const auto at = own.find("transform-origin"); at != own.end()) {
    const auto read = origin_of(at->second, viewport_);
    if (!read) {
      out_.fail(fmt::format("transform-origin \"{:.40}\" is not followed; write it into the transform",
                            at->second));
      return false;
    }
    origin = *read;
  }
  here.translate(origin);
  here = here * *map;
  here.translate(-origin);
  if (!here.matrix().allFinite()) out_.fail("a transform is not finite");
  return !out_.failed();
}

bool SvgReader::draws_nothing(std::string_view name) const {
  constexpr std::array<std::string_view, 22> kSilent{
      "defs",   "style",          "clipPath",       "mask",         "symbol",           "pattern",
      "marker", "linearGradient", "radialGradient", "filter",       "metadata",         "title",
      "desc",   "script",         "view",           "animate",      "animateTransform", "animateMotion",
      "set",    "font",           "font-face",      "color-profile"};
  return name.empty() || std::find(kSilent.begin(), kSilent.end(), name) != kSilent.end();
}

void SvgReader::shape(std::string_view name, const Element& e, const Properties& own, const Inherited& self) {
  const Painted paint =
      painted(self.look, name != "line", [&](std::string_view id) { return named_.contains(id); });
  std::string why = paint.why_hidden;
  if (in_hole_) {
    why = self.look.displayed && self.look.visible ? "" : why;
    if (why.empty() && in_mask_ && (!paint.white || paint.stroke))
      return out_.fail("a mask is not followed; apply it in the drawing program");
  }
  const std::string around = std::exchange(out_.left_out_why, why);
  out_.pen.colour = paint.colour;
  out_.fills = in_hole_ || (paint.fill && !(paint.white && paint.stroke));
  const std::size_t first = out_.count();
  const bool drawable = draw_shape(name, e, own, coordinates(e, own), self.here, out_);
  if (!drawable && why.empty()) out_.unsupported.add(name);
  out_.left_out_why = around;
  out_.fills = false;
  if (in_hole_ && self.look.clips_even_odd && out_.count() > first + 1)
    return out_.fail("clip-rule: evenodd of several parts is not followed; apply it in the drawing program");
  if (out_.failed() || out_.count() == first || !why.empty()) return;
  if (!paint.stroke && !in_hole_) {
    // An area without extent shows nothing.
    for (std::size_t k = first; k < out_.count(); ++k) {
      const geometry::Polyline& line = out_.line(k);
      const double length = geometry::length_m(line);
      if (!line.closed || !(std::abs(geometry::signed_area_m2(line)) > 1e-9 * length * length))
        out_.leave_out(k, "filled without having an area, and without a stroke");
    }
  }
  if (paint.stroke && self.look.dashes != "none" &&
      self.look.dashes.find_first_of("123456789") != std::string::npos)
    ++dashed_;
  if (self.look.markers && (name == "path" || name == "line" || name == "polyline" || name == "polygon"))
    out_.unsupported.add("marker");
  leave_out_background(first, paint);
}

void SvgReader::leave_out_background(std::size_t first, const Painted& paint) {
  if (in_hole_ || !paint.white || (paint.stroke && paint.colour != "#ffffff") ||
      !(page_.size_m.minCoeff() > 0.0))
    return;
  const Vec2 slack = 0.02 * page_.size_m;
  for (std::size_t k = first; k < out_.count(); ++k) {
    const geometry::Box box = geometry::bounding_box(out_.line(k).points_m);
    const bool covers = box.min.x() <= slack.x() && box.max.y() >= -slack.y() &&
                        box.max.x() >= page_.size_m.x() - slack.x() &&
                        box.min.y() <= slack.y() - page_.size_m.y();
    if (covers) out_.leave_out(k, "the white background of the page");
  }
}

/// Its first child that draws and whose conditions are met; what the others draw is left out by name.
void SvgReader::first_choice(const Element& e, const Inherited& self) {
  Inherited at_hand = self;
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const bool shown = is_met(*child) && !at_hand.look.passed_over;
    const std::string before = std::exchange(out_.left_out_why, shown ? out_.left_out_why : "not chosen");
    element(*child, at_hand);
    out_.left_out_why = before;
    at_hand.look.passed_over = at_hand.look.passed_over || (shown && !draws_nothing(svg_name(*child)));
  }
}

/// Draws what is defined elsewhere in the file.
void SvgReader::use(const Element& e, const Properties& own, const Inherited& self) {
  const char* link = attribute(e, "href");
  if (link == nullptr) return out_.unsupported.add("use");  // SVG: it draws nothing
  if (link[0] != '#')
    return out_.fail(
        fmt::format("use of \"{:.60}\": only what the same file defines (#name) is followed", link));
  const Element* target = named(std::string_view(link + 1));
  if (target == nullptr)
    return out_.fail(fmt::format("use of \"{:.60}\", which the file does not define", link));
  if (std::find(in_use_.begin(), in_use_.end(), target) != in_use_.end())
    return out_.fail(fmt::format("use of \"{:.60}\" within itself", link));
  in_use_.push_back(target);
  Inherited within = self;
  within.here.translate(position_of(e, own));
  const std::string_view kind = svg_name(*target);
  if (kind == "symbol" || kind == "svg") {
    const Properties targets = cascade_.of(*target);
    within.look = look_of(targets, self.look);
    if (const auto trouble = trouble_of(targets); !trouble.empty()) out_.fail(trouble);
    if (!out_.failed() && transform(targets, within.here)) {
      if (kind == "svg") within.here.translate(position_of(*target, targets));
      const SvgCoordinates at = coordinates(*target, targets);
      const SvgCoordinates asked = coordinates(e, own);
      viewport(*target, targets, within,
               {asked("width", at("width", viewport_.x())), asked("height", at("height", viewport_.y()))});
    }
  } else {
    element(*target, within);
  }
  in_use_.pop_back();
}

Vec2 SvgReader::position_of(const Element& e, const Properties& own) {
  const SvgCoordinates at = coordinates(e, own);
  return Vec2(at("x"), at("y"));
}

void SvgReader::viewport(const Element& e, const Properties& own, const Inherited& self, const Vec2& size) {
  for (const char* name : {"refX", "refY"}) {
    const char* text = e.Attribute(name);
    if (text != nullptr && std::string_view(text) != "0" && svg_name(e) == "symbol")
      return out_.fail(
          fmt::format("{} \"{:.20}\" of a symbol is not followed; move its parts instead", name, text));
  }
  const Vec2 around = viewport_;
  const auto box = view_box_of(e);
  if (!box) return out_.fail(box.error());
  if (*box && !(size.minCoeff() > 0.0)) return out_.fail("a viewBox is shown in no area");
  viewport_ = *box ? (*box)->size : size;
  Inherited within = self;
  if (*box) within.here = within.here * fitted(**box, size, aspect_of(e));
  const std::size_t first = out_.count();
  children(e, within);
  viewport_ = around;
  // Of a page whose size is not known nothing is a part.
  const bool nowhere = !(size.minCoeff() > 0.0) && around.minCoeff() > 0.0;
  for (std::size_t k = first; nowhere && k < out_.count(); ++k)
    if (out_.is_kept(k)) out_.leave_out(k, "in an area without any size");
  if (!clips(own) || !(size.minCoeff() > 0.0)) return;
  geometry::Polyline frame{{}, true};
  for (const Vec2& corner : {Vec2(0, 0), Vec2(size.x(), 0), Vec2(size.x(), size.y()), Vec2(0, size.y())})
    frame.points_m.push_back(out_.placed(self.here * corner));
  const std::string name(svg_name(e));
  clip_by({frame}, first, fmt::format("the area of its <{}>", name), fmt::format("the area of a <{}>", name));
}

std::vector<geometry::Polyline> SvgReader::hole_of(const Element& e, const Inherited& self, bool mask) {
  DrawnLines scratch(limits_, request_, {page_.metres, -page_.metres});
  std::swap(out_, scratch);
  const bool in_hole = std::exchange(in_hole_, true);
  const bool in_mask = std::exchange(in_mask_, mask);
  Inherited within = self;
  const Properties own = cascade_.of(e);
  within.look = look_of(own, {});
  if (own.contains("clip-path") && own.at("clip-path") != "none")
    out_.fail("a clip-path of a clip-path is not followed");
  const char* units = e.Attribute(mask ? "maskContentUnits" : "clipPathUnits");
  if (units != nullptr && std::string_view(units) == "objectBoundingBox")
    out_.fail(
        "a clip-path or mask in units of an object's box is not followed; apply it in the drawing program");
  if (transform(own, within.here)) children(e, within);
  std::swap(out_, scratch);
  in_hole_ = in_hole;
  in_mask_ = in_mask;
  std::vector<geometry::Polyline> out;
  if (scratch.failed()) {
    const auto refused = scratch.drawing("SVG");
    out_.fail(refused.error());
    return out;
  }
  for (std::size_t k = 0; k < scratch.count(); ++k) {
    if (scratch.line(k).closed && scratch.is_kept(k)) out.push_back(scratch.line(k));
  }
  return out;
}

void SvgReader::clip(const Properties& own, const Inherited& self, std::size_t first) {
  for (const std::string_view kind : {"clip-path", "mask"}) {
    const auto written = own.find(kind);
    if (written == own.end() || written->second == "none" || out_.count() == first) continue;
    const std::string_view id = reference(written->second);
    if (id.empty())
      return out_.fail(fmt::format("{} \"{:.40}\" is not followed; apply it in the drawing program", kind,
                                   written->second));
    const Element* target = named(id);
    const std::string_view name = target != nullptr ? svg_name(*target) : std::string_view();
    if (name != "clipPath" && name != "mask") continue;  // it hides nothing
    if (std::find(in_use_.begin(), in_use_.end(), target) != in_use_.end())
      return out_.fail("a clip-path is within itself");
    in_use_.push_back(target);
    const auto hole = hole_of(*target, self, name == "mask");
    in_use_.pop_back();
    if (out_.failed()) return;
    clip_by(hole, first, fmt::format("its {}", kind), fmt::format("{} \"#{:.40}\"", kind, id));
  }
}

void SvgReader::clip_by(const std::vector<geometry::Polyline>& hole, std::size_t first,
                        const std::string& its, const std::string& name) {
  std::size_t work = 0;
  for (const auto& ring : hole) work += ring.size();
  for (std::size_t k = first; k < out_.count() && !out_.failed(); ++k) {
    if (!out_.is_kept(k)) continue;
    visited_ += out_.line(k).size() * work / 1000;
    if (visited_ > 10 * limits_.max_points) return out_.fail("clip-paths are too large to be followed");
    const Clipped seen = clipped(out_.line(k), hole);
    if (seen == Clipped::kOutside) out_.leave_out(k, "outside " + its);
    if (seen == Clipped::kCut) out_.fail(name + " cuts through a shape; apply it in the drawing program");
  }
}

}  // namespace telekerf::vision
