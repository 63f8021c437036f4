// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/style.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cctype>
#include <cstring>
#include <string>
#include <string_view>

namespace telekerf::vision {
namespace {

/// The style attribute without blanks, each property behind a semicolon.
std::string flat_style(const tinyxml2::XMLElement& e) {
  const char* style = e.Attribute("style");
  std::string flat(1, ';');
  for (const char* c = style; c != nullptr && *c != 0 && flat.size() < 4096; ++c) {
    if (std::isspace(static_cast<unsigned char>(*c)) == 0) flat.push_back(*c);
  }
  return flat;
}

}  // namespace

bool is_hidden(const tinyxml2::XMLElement& e) {
  const auto is = [&](const char* name, const char* value) {
    const char* text = e.Attribute(name);
    return text != nullptr && std::strcmp(text, value) == 0;
  };
  if (is("display", "none") || is("visibility", "hidden")) return true;
  const std::string flat = flat_style(e);
  return flat.find("display:none") != std::string::npos ||
         flat.find("visibility:hidden") != std::string::npos;
}

void note_effects(const tinyxml2::XMLElement& e, DrawnLines& out) {
  const std::string flat = flat_style(e);
  for (const char* name : {"clip-path", "mask", "marker", "marker-start", "marker-mid", "marker-end"}) {
    const char* text = e.Attribute(name);
    const bool has = text != nullptr && std::strcmp(text, "none") != 0;
    if (has || flat.find(fmt::format(";{}:url", name)) != std::string::npos) out.unsupported.add(name);
  }
  if (flat.find(";transform:") != std::string::npos)
    out.fail("a transform within a style is not read; write it as the element's own transform");
}

void note_style_sheet(const tinyxml2::XMLElement& e, DrawnLines& out) {
  const char* text = e.GetText();
  const std::string_view sheet = text != nullptr ? text : "";
  for (const std::string_view rule : {"display", "visibility", "transform"}) {
    if (sheet.find(rule) != std::string_view::npos) out.unsupported.add("rules of a style sheet");
  }
}

}  // namespace telekerf::vision
