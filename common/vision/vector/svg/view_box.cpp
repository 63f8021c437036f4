// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/view_box.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

bool has(std::string_view aspect, std::string_view word) {
  return aspect.find(word) != std::string_view::npos;
}

}  // namespace

tl::expected<ViewBox, std::string> read_view_box(std::string_view text) {
  std::string_view rest = text;
  ViewBox box;
  for (double* value : {&box.corner.x(), &box.corner.y(), &box.size.x(), &box.size.y()}) {
    const auto number = take_number(rest);
    if (!number) return tl::unexpected(fmt::format("viewBox \"{:.60}\" cannot be read", text));
    *value = *number;
  }
  if (!(box.size.minCoeff() > 0.0)) return tl::unexpected<std::string>("the viewBox has no area");
  return box;
}

Vec2 scale_of(const ViewBox& box, const Vec2& size, std::string_view aspect) {
  Vec2 scale = size.cwiseQuotient(box.size);
  if (!has(aspect, "none")) scale.setConstant(has(aspect, "slice") ? scale.maxCoeff() : scale.minCoeff());
  return scale;
}

Eigen::Affine2d fitted(const ViewBox& box, const Vec2& size, std::string_view aspect) {
  const Vec2 scale = scale_of(box, size, aspect);
  const Vec2 part(has(aspect, "xMin")   ? 0.0
                  : has(aspect, "xMax") ? 1.0
                                        : 0.5,
                  has(aspect, "YMin")   ? 0.0
                  : has(aspect, "YMax") ? 1.0
                                        : 0.5);
  const Vec2 spare = size - scale.cwiseProduct(box.size);
  Eigen::Affine2d out = Eigen::Affine2d::Identity();
  out.translate(part.cwiseProduct(spare)).scale(scale).translate(-box.corner);
  return out;
}

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

}  // namespace telekerf::vision
