// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/page.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "common/vision/vector/number.h"
#include "common/vision/vector/svg/view_box.h"
#include "common/vision/vector/svg/xml.h"

namespace telekerf::vision {
namespace {

/// A length without a unit, or in px.
bool in_pixels(std::string_view text) {
  const auto value = take_number(text);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return value && (text.empty() || text == "px");
}

struct Pixels {
  double an_inch = 96.0;
  std::string why = "96 pixels an inch, as CSS has it";
};

/// What programs took that did not keep to CSS.
Pixels pixels_of(const tinyxml2::XMLElement& root, std::string_view text, const VectorRequest& request) {
  if (request.dpi) return {*request.dpi, fmt::format("{:g} pixels an inch, as asked for", *request.dpi)};
  const std::string_view head = text.substr(0, 4096);
  const bool illustrator = head.find("Adobe Illustrator") != std::string_view::npos ||
                           head.find("ns.adobe.com/AdobeIllustrator") != std::string_view::npos ||
                           (root.Attribute("data-name") != nullptr && root.Attribute("id") != nullptr);
  if (illustrator)
    return {72.0, "72 pixels an inch, as Adobe Illustrator writes them (--dpi 96 if it is not so)"};
  for (auto* a = root.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (local_name(a->Name()) != "version" || std::string_view(a->Name()) == "version") continue;
    std::string_view rest(a->Value());
    const auto version = take_number(rest);
    if (version && *version < 0.92)
      return {90.0, fmt::format("90 pixels an inch, as Inkscape {:.8} wrote them (--dpi 96 if it is not so)",
                                a->Value())};
  }
  return {};
}

/// A length of the page itself; nothing where it is left to the viewer (no length, auto, a per cent). What is
/// no length is refused, since the drawing would then come out in some other size than meant.
tl::expected<std::optional<double>, std::string> page_length_of(const tinyxml2::XMLElement& root,
                                                                const char* name, double pixel_m) {
  const char* text = root.Attribute(name);
  if (text == nullptr || std::strcmp(text, "auto") == 0 || std::strchr(text, '%') != nullptr)
    return std::nullopt;
  const auto length_m = svg_length_m(text);
  if (length_m && *length_m > 0.0) return in_pixels(text) ? *length_m * pixel_m / kCssPixel_m : *length_m;
  return tl::unexpected(
      fmt::format("{} = \"{:.30}\" is no length above 0; write it like \"100.5mm\"", name, text));
}

}  // namespace

tl::expected<SvgPage, std::string> page_of(const tinyxml2::XMLElement& root, std::string_view text,
                                           const VectorRequest& request) {
  const Pixels pixels = pixels_of(root, text, request);
  const double pixel_m = 25.4e-3 / pixels.an_inch;
  const auto width = page_length_of(root, "width", pixel_m);
  if (!width) return tl::unexpected(width.error());
  const auto height = page_length_of(root, "height", pixel_m);
  if (!height) return tl::unexpected(height.error());
  const auto box = view_box_of(root);
  if (!box) return tl::unexpected(box.error());
  SvgPage out;
  out.metres = pixel_m;
  const char* stated = *width ? root.Attribute("width") : *height ? root.Attribute("height") : nullptr;
  out.size_from = stated != nullptr && !in_pixels(stated)
                      ? fmt::format("the file's page, {:.20} {}", stated, *width ? "wide" : "high")
                      : pixels.why;
  out.size_m = {width->value_or(0.0), height->value_or(0.0)};
  if (*box) {
    Vec2 scale = Vec2::Constant(pixel_m);
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
  if (request.unit_m) {
    const Vec2 aspect = *box ? Vec2((*box)->size) : Vec2(out.size_m / out.metres);
    out.metres = *request.unit_m;
    out.size_m = out.metres * aspect;
    if (*box) {
      out.view = Eigen::Affine2d::Identity();
      out.view.translate(-(*box)->corner);
    }
    out.size_from = fmt::format("a unit is {:g} mm, as asked for", 1e3 * out.metres);
  }
  if (!(out.metres > 0.0) || !std::isfinite(out.metres))
    return tl::unexpected<std::string>("the drawing's size is not positive");
  out.units = *box ? (*box)->size : Vec2(out.size_m / out.metres);
  return out;
}

}  // namespace telekerf::vision
