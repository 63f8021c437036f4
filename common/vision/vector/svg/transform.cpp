// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/transform.h"

#include <cctype>
#include <cmath>
#include <vector>

#include "common/runtime/vectors.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {
namespace {

using Affine = Eigen::Affine2d;

/// One function of a transform attribute with its numbers; nothing where there is none such.
std::optional<Affine> function_of(std::string_view name, const std::vector<double>& v) {
  const std::size_t n = v.size();
  const double degree = M_PI / 180.0;
  Affine out = Affine::Identity();
  if (name == "matrix" && n == 6) {
    out.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0, 0, 1;
  } else if (name == "translate" && (n == 1 || n == 2)) {
    out.translate(Vec2(v[0], n == 2 ? v[1] : 0.0));
  } else if (name == "scale" && (n == 1 || n == 2)) {
    out.scale(Vec2(v[0], n == 2 ? v[1] : v[0]));
  } else if (name == "rotate" && n == 1) {
    out.rotate(v[0] * degree);
  } else if (name == "rotate" && n == 3) {
    out.translate(Vec2(v[1], v[2])).rotate(v[0] * degree).translate(Vec2(-v[1], -v[2]));
  } else if (name == "skewX" && n == 1) {
    out.matrix()(0, 1) = std::tan(v[0] * degree);
  } else if (name == "skewY" && n == 1) {
    out.matrix()(1, 0) = std::tan(v[0] * degree);
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
      const auto number = take_number(inside);
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

}  // namespace telekerf::vision
