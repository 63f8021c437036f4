// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/lengths.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "common/vision/vector/number.h"

namespace telekerf::vision {

std::optional<double> svg_length_m(const char* text) {
  if (text == nullptr) return std::nullopt;
  std::string_view rest(text);
  const auto value = take_number(rest);
  if (!value) return std::nullopt;
  while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.back())) != 0) rest.remove_suffix(1);
  constexpr std::array<std::pair<std::string_view, double>, 9> kUnits{{{"", kCssPixel_m},
                                                                       {"px", kCssPixel_m},
                                                                       {"mm", 1e-3},
                                                                       {"cm", 1e-2},
                                                                       {"m", 1.0},
                                                                       {"in", 25.4e-3},
                                                                       {"pt", 25.4e-3 / 72.0},
                                                                       {"pc", 25.4e-3 / 6.0},
                                                                       {"q", 0.25e-3}}};
  std::string unit(rest);
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const auto& [name, metres] : kUnits) {
    if (unit == name) return *value * metres;
  }
  return std::nullopt;
}

double SvgCoordinates::operator()(const char* name, double fallback) const {
  const auto styled = own_.find(name);
  const char* text = styled != own_.end() ? styled->second.c_str() : element_.Attribute(name);
  if (text == nullptr || std::strcmp(text, "auto") == 0) return fallback;
  if (const auto metres = svg_length_m(text)) return *metres / kCssPixel_m;
  std::string_view rest(text);
  const auto percent = take_number(rest);
  if (!percent || rest != "%") {
    out_.fail(fmt::format("{} = \"{:.30}\" is not a length that is understood", name, text));
    return fallback;
  }
  const std::string_view axis(name);
  if (axis == "width" || axis.find('x') != std::string_view::npos) return 0.01 * *percent * viewport_.x();
  if (axis == "height" || axis.find('y') != std::string_view::npos) return 0.01 * *percent * viewport_.y();
  return 0.01 * *percent * viewport_.norm() / std::sqrt(2.0);
}

}  // namespace telekerf::vision
