// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/csv.h"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <optional>

#include "common/vision/vector/number.h"

namespace telekerf::vision {

std::string to_csv(const geometry::Polyline& line) {
  std::string out = "x_m,y_m\n";
  for (const Vec2& p : line.points_m) fmt::format_to(std::back_inserter(out), "{},{}\n", p.x(), p.y());
  return out;
}

std::string to_csv(std::span<const geometry::Polyline> contours, std::size_t first) {
  std::string out = "x_m,y_m,contour\n";
  const auto write = [&](std::size_t k) {
    for (const Vec2& p : contours[k].points_m)
      fmt::format_to(std::back_inserter(out), "{},{},{}\n", p.x(), p.y(), k);
  };
  if (first < contours.size()) write(first);
  for (std::size_t k = 0; k < contours.size(); ++k) {
    if (k != first) write(k);
  }
  return out;
}

tl::expected<std::vector<Vec2>, std::string> points_from_csv(std::string_view text) {
  std::vector<Vec2> out;
  std::size_t number = 0;
  bool numbered = false;
  std::optional<double> contour;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    std::string_view rest = line;
    skip_separators(rest);
    if (rest.empty() || rest.front() == '#') continue;
    const auto x = take_number(rest);
    const auto y = x ? take_number(rest) : std::nullopt;
    while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) rest.remove_suffix(1);
    const bool heading = number == 1 && !x && line.find_first_of("0123456789") == std::string_view::npos &&
                         line.find("nan") == std::string_view::npos &&
                         line.find("inf") == std::string_view::npos;
    if (heading) {
      numbered = line.find("contour") != std::string_view::npos;
      continue;
    }
    if (numbered && y) {
      const auto own = take_number(rest);
      if (own && !contour) contour = own;
      if (own && own != contour) continue;
    }
    while (numbered && !rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    if (!y || !rest.empty()) {
      return tl::unexpected(fmt::format("line {}: \"{:.40}\" is not two finite numbers x,y", number, line));
    }
    out.emplace_back(*x, *y);
  }
  if (out.empty()) return tl::unexpected<std::string>("there is no point in it");
  return out;
}

}  // namespace telekerf::vision
