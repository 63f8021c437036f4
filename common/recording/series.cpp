// SPDX-License-Identifier: Apache-2.0
#include "common/recording/series.h"

#include <algorithm>
#include <cctype>

namespace telekerf {
namespace {

/// "tool_x_m" of unit "m" -> "tool_x".
std::string without_unit(const SeriesColumn& column) {
  if (column.name == "t_s") return "time";
  std::string suffix = "_" + column.unit;
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (column.unit.empty() || !column.name.ends_with(suffix)) return column.name;
  return column.name.substr(0, column.name.size() - suffix.size());
}

}  // namespace

std::vector<Quantity> quantities_of(const SeriesSchema& schema) {
  std::vector<Quantity> all;
  const auto name_at = [&](std::size_t n) {
    return n < schema.width() ? without_unit(schema.columns[n]) : std::string();
  };
  for (std::size_t n = 0; n < schema.width();) {
    std::string name = name_at(n);
    if (!name.ends_with("_x")) {
      all.push_back({std::move(name), n, 1, ""});
      ++n;
      continue;
    }
    const std::string base = name.substr(0, name.size() - 2);
    std::size_t count = 1;
    for (const char* axis : {"_y", "_z"}) {
      if (name_at(n + count) != base + axis) break;
      ++count;
    }
    all.push_back({base, n, count, count == 3 ? "x y z" : count == 2 ? "x y" : "x"});
    n += count;
  }
  return all;
}

}  // namespace telekerf
