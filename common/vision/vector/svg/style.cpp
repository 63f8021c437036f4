// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/vision/vector/colour_names.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

std::string flat(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
      out.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  }
  return out;
}

/// A fraction or a per cent; the fallback where it is neither.
double share_of(std::string_view text, double fallback) {
  const auto value = take_number(text);
  if (!value) return fallback;
  return text.starts_with('%') ? 0.01 * *value : *value;
}

struct Paint {
  bool paints = false;
  std::string colour;
};

/// CSS Color 4, section 7.1: a hue in degrees, saturation and lightness as shares -> red, green, blue in
/// 0..1.
std::array<double, 3> rgb_of_hsl(double hue, double saturation, double lightness) {
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr std::array<double, 3> kShift{0.0, 8.0, 4.0};
    double k = std::fmod(kShift[i] + hue / 30.0, 12.0);
    if (k < 0.0) k += 12.0;
    const double a = saturation * std::min(lightness, 1.0 - lightness);
    out[i] = lightness - a * std::max(-1.0, std::min({k - 3.0, 9.0 - k, 1.0}));
  }
  return out;
}

/// "rgb(1,2,3)", "rgba(1,2,3,0)", "rgb(1 2 3 / 0%)", "hsla(...)"
Paint function_paint(std::string_view text) {
  const bool rgb = text.starts_with("rgb");
  const auto open = text.find('(');
  std::string_view rest = text.substr(std::min(text.size(), open + 1));
  std::vector<double> values;
  std::vector<bool> percent;
  while (values.size() < 5) {
    skip_separators(rest);
    if (rest.starts_with('/')) {
      rest.remove_prefix(1);
      continue;
    }
    const auto value = take_number(rest);
    if (!value) break;
    values.push_back(*value);
    percent.push_back(rest.starts_with('%'));
    while (!rest.empty() &&
           (rest.front() == '%' || std::isalpha(static_cast<unsigned char>(rest.front())) != 0))
      rest.remove_prefix(1);
  }
  if (values.size() >= 4 && !(values[3] > 0.0)) return {};
  if (text.starts_with("hsl") && values.size() >= 3) {
    const auto share = [&](std::size_t i) { return std::clamp(0.01 * values[i], 0.0, 1.0); };
    const auto c = rgb_of_hsl(values[0], share(1), share(2));
    return {true, fmt::format("#{:02x}{:02x}{:02x}", std::lround(255.0 * c[0]), std::lround(255.0 * c[1]),
                              std::lround(255.0 * c[2]))};
  }
  if (!rgb || values.size() < 3) return {true, std::string(text)};
  std::array<int, 3> c{};
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = static_cast<int>(std::clamp(percent[i] ? 2.55 * values[i] : values[i], 0.0, 255.0) + 0.5);
  return {true, fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2])};
}

Paint paint_of(std::string_view written, const Look& look, const IsDefined& is_defined, int depth = 0) {
  std::string text(written);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  if (text.empty() || text == "none" || text == "transparent") return {};
  if (text == "currentcolor")
    return depth > 0 ? Paint{true, "black"} : paint_of(look.color, look, is_defined, 1);
  if (text.starts_with("url")) {
    const auto hash = written.find('#');
    const auto close = written.find(')');
    if (hash == std::string_view::npos || close == std::string_view::npos || close < hash)
      return {true, "url"};
    std::string_view id = written.substr(hash + 1, close - hash - 1);
    while (!id.empty() && (id.back() == '"' || id.back() == '\'' || id.back() == ' ')) id.remove_suffix(1);
    if (is_defined(id)) return {true, fmt::format("#{}", id)};
    std::string_view fallback = written.substr(close + 1);
    skip_separators(fallback);
    return fallback.empty() || depth > 1 ? Paint{} : paint_of(fallback, look, is_defined, depth + 1);
  }
  if (text.front() == '#') {
    const std::string_view hex = std::string_view(text).substr(1);
    const bool zero_alpha =
        (hex.size() == 4 && hex.back() == '0') || (hex.size() == 8 && hex.substr(6) == "00");
    if (zero_alpha) return {};
    if (hex.size() == 3 || hex.size() == 4)
      return {true, fmt::format("#{0}{0}{1}{1}{2}{2}", hex[0], hex[1], hex[2])};
    return {true, text.substr(0, 7)};
  }
  if (text.find('(') != std::string::npos) return function_paint(text);
  return {true, named_colour(text).value_or(text)};
}

bool is_white(const std::string& colour) {
  if (colour.size() != 7 || colour[0] != '#') return false;
  return colour[1] == 'f' && colour[3] == 'f' && colour[5] == 'f' && colour[2] >= 'a' && colour[4] >= 'a' &&
         colour[6] >= 'a';
}

}  // namespace

Look look_of(const Properties& own, const Look& around) {
  Look out = around;
  out.markers = around.markers;
  const auto with = [&](std::string_view name, auto&& take) {
    const auto found = own.find(name);
    if (found == own.end()) return;
    const std::string value = flat(found->second);
    if (value == "inherit" || value == "unset") return;
    take(found->second, value);
  };
  const auto word = [](std::string& to, const char* initial) {
    return [&to, initial](const std::string& text, const std::string& value) {
      to = value == "initial" ? initial : text;
    };
  };
  with("color", word(out.color, "black"));
  with("fill", word(out.fill, "black"));
  with("stroke", word(out.stroke, "none"));
  with("stroke-width", word(out.stroke_width, "1"));
  with("stroke-dasharray", word(out.dashes, "none"));
  with("fill-opacity", [&](const auto&, const auto& v) { out.fill_opacity = share_of(v, 1.0); });
  with("stroke-opacity", [&](const auto&, const auto& v) { out.stroke_opacity = share_of(v, 1.0); });
  with("opacity", [&](const auto&, const auto& v) { out.opaque = out.opaque && share_of(v, 1.0) > 0.0; });
  with("display", [&](const auto&, const auto& v) { out.displayed = out.displayed && v != "none"; });
  with("visibility", [&](const auto&, const auto& v) { out.visible = v != "hidden" && v != "collapse"; });
  with("clip-rule", [&](const auto&, const auto& v) { out.clips_even_odd = v == "evenodd"; });
  for (const std::string_view name : {"marker", "marker-start", "marker-mid", "marker-end"}) {
    with(name, [&](const auto&, const auto& v) { out.markers = v != "none"; });
  }
  return out;
}

Painted painted(const Look& look, bool area, const IsDefined& is_defined) {
  Painted out;
  const Paint fill = paint_of(look.fill, look, is_defined);
  const Paint stroke = paint_of(look.stroke, look, is_defined);
  out.fill = area && fill.paints && look.fill_opacity > 0.0;
  out.stroke = stroke.paints && look.stroke_opacity > 0.0 && share_of(flat(look.stroke_width), 1.0) > 0.0;
  out.white = out.fill && is_white(fill.colour);
  out.colour = out.stroke ? stroke.colour : fill.colour;
  if (look.passed_over) {
    out.why_hidden = "for another language or program (switch)";
  } else if (!look.displayed) {
    out.why_hidden = "hidden (display: none)";
  } else if (!look.visible) {
    out.why_hidden = "hidden (visibility)";
  } else if (!look.opaque) {
    out.why_hidden = "hidden (opacity 0)";
  } else if (!out.fill && !out.stroke) {
    out.why_hidden = "painted by neither fill nor stroke";
  }
  return out;
}

std::string trouble_of(const Properties& own) {
  for (const std::string_view name : {"translate", "rotate", "scale", "offset-path", "offset", "zoom"}) {
    const auto found = own.find(name);
    if (found == own.end()) continue;
    const std::string value = flat(found->second);
    if (value != "none" && value != "normal" && value != "initial" && !(name == "zoom" && value == "1"))
      return fmt::format(
          "the style \"{}: {:.30}\" moves an element and is not followed; write it as its transform", name,
          found->second);
  }
  for (const auto& [name, value] : own) {
    if (value.find("var(") != std::string::npos || value.find("calc(") != std::string::npos)
      return fmt::format("\"{}: {:.40}\" is not a value that is understood; write it out", name, value);
  }
  for (const std::string_view name : {"all", "clip", "content-visibility"}) {
    const auto found = own.find(name);
    if (found == own.end()) continue;
    const std::string value = flat(found->second);
    if (value != "auto" && value != "visible")
      return fmt::format("the style \"{}: {:.30}\" is not followed", name, found->second);
  }
  return {};
}

}  // namespace telekerf::vision
