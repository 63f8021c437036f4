// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/page.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "common/vision/vector/svg/view_box.h"

namespace telekerf::vision {
namespace {

/// A length of the page itself; nothing where it is left to the viewer (no length, auto, a per cent). What is
/// no length is refused, since the drawing would then come out in some other size than meant.
tl::expected<std::optional<double>, std::string> page_length_of(const tinyxml2::XMLElement& root,
                                                                const char* name) {
  const char* text = root.Attribute(name);
  if (text == nullptr || std::strcmp(text, "auto") == 0 || std::strchr(text, '%') != nullptr)
    return std::nullopt;
  const auto length_m = svg_length_m(text);
  if (length_m && *length_m > 0.0) return length_m;
  return tl::unexpected(
      fmt::format("{} = \"{:.30}\" is no length above 0; write it like \"100.5mm\"", name, text));
}

}  // namespace

tl::expected<SvgPage, std::string> page_of(const tinyxml2::XMLElement& root) {
  const auto width = page_length_of(root, "width");
  if (!width) return tl::unexpected(width.error());
  const auto height = page_length_of(root, "height");
  if (!height) return tl::unexpected(height.error());
  const auto box = view_box_of(root);
  if (!box) return tl::unexpected(box.error());
  SvgPage out;
  out.size_m = {width->value_or(0.0), height->value_or(0.0)};
  if (*box) {
    Vec2 scale = Vec2::Constant(kCssPixel_m);
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

}  // namespace telekerf::vision
