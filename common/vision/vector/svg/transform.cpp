// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/transform.h"

#include <array>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include "common/runtime/vectors.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;

/// A number of a transform with its unit: lengths in user units, angles in degrees.
std::optional<double> take_value(std::string_view& text) {
  const auto number = take_number(text);
  if (!number) return std::nullopt;
  std::size_t letters = 0;
  while (letters < text.size() &&
         (std::isalpha(static_cast<unsigned char>(text[letters])) != 0 || text[letters] == '%'))
    ++letters;
  const std::string_view unit = text.substr(0, letters);
  text.remove_prefix(letters);
  constexpr std::array<std::pair<std::string_view, double>, 10> kUnits{{{"", 1.0},
                                                                        {"px", 1.0},
                                                                        {"deg", 1.0},
                                                                        {"rad", 180.0 / M_PI},
                                                                        {"grad", 0.9},
                                                                        {"turn", 360.0},
                                                                        {"mm", 96.0 / 25.4},
                                                                        {"cm", 960.0 / 25.4},
                                                                        {"in", 96.0},
                                                                        {"pt", 96.0 / 72.0}}};
  for (const auto& [name, factor] : kUnits) {
    if (unit == name) return *number * factor;
  }
  return std::nullopt;
}

/// One function of a transform with its numbers; nothing where there is none such.
std::optional<Affine> function_of(std::string_view name, const std::vector<double>& v) {
  const std::size_t n = v.size();
  const double degree = M_PI / 180.0;
  Affine out = Affine::Identity();
  if (name == "matrix" && n == 6) {
    out.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0, 0, 1;
  } else if (name == "translate" && (n == 1 || n == 2)) {
    out.translate(Vec2(v[0], n == 2 ? v[1] : 0.0));
  } else if (name == "translateX" && n == 1) {
    out.translate(Vec2(v[0], 0.0));
  } else if (name == "translateY" && n == 1) {
    out.translate(Vec2(0.0, v[0]));
  } else if (name == "scale" && (n == 1 || n == 2)) {
    out.scale(Vec2(v[0], n == 2 ? v[1] : v[0]));
  } else if (name == "scaleX" && n == 1) {
    out.scale(Vec2(v[0], 1.0));
  } else if (name == "scaleY" && n == 1) {
    out.scale(Vec2(1.0, v[0]));
  } else if (name == "rotate" && n == 1) {
    out.rotate(v[0] * degree);
  } else if (name == "rotate" && n == 3) {
    out.translate(Vec2(v[1], v[2])).rotate(v[0] * degree).translate(Vec2(-v[1], -v[2]));
  } else if (name == "skewX" && n == 1) {
    out.matrix()(0, 1) = std::tan(v[0] * degree);
  } else if (name == "skewY" && n == 1) {
    out.matrix()(1, 0) = std::tan(v[0] * degree);
  } else if (name == "skew" && (n == 1 || n == 2)) {
    out.matrix()(0, 1) = std::tan(v[0] * degree);
    if (n == 2) out.matrix()(1, 0) = std::tan(v[1] * degree);
  } else {
    return std::nullopt;
  }
  return out;
}

}  // namespace

std::optional<Affine> transform_of(std::string_view text) {
  constexpr std::size_t kMaxNumbers = 6;
  Affine total = Affine::Identity();
  skip_separators(text);
  if (text == "none") return total;
  while (!text.empty()) {
    const auto open = text.find('(');
    const auto close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open)
      return std::nullopt;
    std::string_view name = text.substr(0, open);
    while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back())) != 0) name.remove_suffix(1);
    std::string_view inside = text.substr(open + 1, close - open - 1);
    std::vector<double> numbers;
    while (numbers.size() <= kMaxNumbers) {
      const auto number = take_value(inside);
      if (!number) break;
      numbers.push_back(*number);
    }
    skip_separators(inside);
    const auto one = inside.empty() ? function_of(name, numbers) : std::nullopt;
    if (!one) return std::nullopt;
    total = total * *one;
    text.remove_prefix(close + 1);
    skip_separators(text);
  }
  return total;
}

std::optional<Vec2> origin_of(std::string_view text, const Vec2& viewport) {
  Vec2 out = 0.5 * viewport;
  int axis = 0;
  while (true) {
    skip_separators(text);
    if (text.empty()) return axis > 0 ? std::optional(out) : std::nullopt;
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,"));
    std::string_view rest = word;
    if (axis > 2) return std::nullopt;
    if (word == "left" || word == "right") {
      out.x() = word == "left" ? 0.0 : viewport.x();
    } else if (word == "top" || word == "bottom") {
      out.y() = word == "top" ? 0.0 : viewport.y();
    } else if (word == "center") {
      if (axis < 2) out[axis] = 0.5 * viewport[axis];
    } else {
      std::string_view number_text = word;
      const auto number = take_number(number_text);
      if (number && number_text == "%") {
        if (axis < 2) out[axis] = 0.01 * *number * viewport[axis];
      } else {
        const auto value = take_value(rest);
        if (!value || !rest.empty()) return std::nullopt;
        if (axis < 2) out[axis] = *value;
      }
    }
    text.remove_prefix(word.size());
    ++axis;
  }
}

}  // namespace telekerf::vision
