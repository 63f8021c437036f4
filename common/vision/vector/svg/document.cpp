// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/document.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include "common/vision/vector/svg/page.h"
#include "common/vision/vector/svg/reader.h"
#include "common/vision/vector/svg/xml.h"
#include "common/vision/vector/text_encoding.h"

namespace telekerf::vision {

tl::expected<VectorDrawing, std::string> read_svg(std::string_view bytes, const VectorLimits& limits,
                                                  const VectorRequest& request) {
  if (bytes.size() > limits.max_bytes) {
    return tl::unexpected(fmt::format("the SVG file is larger than {} MB", limits.max_bytes / 1000000));
  }
  const auto text = with_entities(utf8_of(bytes), limits.max_bytes);
  if (!text) return tl::unexpected(text.error());
  tinyxml2::XMLDocument document;
  const auto state = document.Parse(text->data(), text->size());
  if (state == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
    return tl::unexpected<std::string>("groups are nested too deeply; ungroup the drawing");
  if (state != tinyxml2::XML_SUCCESS) {
    return tl::unexpected(
        fmt::format("not an SVG file: its XML is damaged in line {}", document.ErrorLineNum()));
  }
  for (auto* node = document.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToDeclaration() != nullptr && std::string_view(node->Value()).starts_with("xml-stylesheet")) {
      return tl::unexpected<std::string>(
          "a style sheet of another file (xml-stylesheet) is not read; put its rules into a <style> of this "
          "one");
    }
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || svg_name(*root) != "svg") {
    return tl::unexpected<std::string>("not an SVG file: its root element is not <svg>");
  }
  const auto page = page_of(*root, *text, request);
  if (!page) return tl::unexpected(page.error());
  auto out = SvgReader(*root, *page, limits, request).drawing();
  if (!out) return out;
  out->page_width_m = page->size_m.x();
  out->page_height_m = page->size_m.y();
  out->size_from = page->size_from;
  return out;
}

}  // namespace telekerf::vision
