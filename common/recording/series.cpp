// SPDX-License-Identifier: Apache-2.0
#include "common/recording/series.h"

#include <algorithm>
#include <cctype>

namespace telekerf {
namespace {

/// As it stands in a name: "m/s^2" -> "_m_per_s2".
std::string suffix_of(const std::string& unit) {
  std::string suffix = "_";
  for (const char c : unit) {
    if (c == '/') {
      suffix += "_per_";
    } else if (c != '^') {
      suffix += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return suffix;
}

/// "tool_x_m" of unit "m" -> "tool_x".
std::string without_unit(const SeriesColumn& column) {
  if (column.name == "t_s") return "time";
  const std::string suffix = suffix_of(column.unit);
  if (column.unit.empty() || !column.name.ends_with(suffix)) return column.name;
  return column.name.substr(0, column.name.size() - suffix.size());
}

}  // namespace

std::vector<Quantity> quantities_of(const SeriesSchema& schema) {
  std::vector<Quantity> all;
  // Place and velocity of the same thing: the second keeps its unit.
  const auto add = [&](std::string name, std::size_t first, std::size_t count, const char* axes) {
    const bool taken = std::any_of(all.begin(), all.end(), [&](const Quantity& q) { return q.name == name; });
    if (taken) name += suffix_of(schema.columns[first].unit);
    all.push_back({std::move(name), first, count, axes});
  };
  const auto name_at = [&](std::size_t n) {
    return n < schema.width() ? without_unit(schema.columns[n]) : std::string();
  };
  for (std::size_t n = 0; n < schema.width();) {
    std::string name = name_at(n);
    if (!name.ends_with("_x")) {
      add(std::move(name), n, 1, "");
      ++n;
      continue;
    }
    const std::string base = name.substr(0, name.size() - 2);
    std::size_t count = 1;
    for (const char* axis : {"_y", "_z"}) {
      if (name_at(n + count) != base + axis || schema.columns[n + count].unit != schema.columns[n].unit) break;
      ++count;
    }
    add(base, n, count, count == 3 ? "x y z" : count == 2 ? "x y" : "x");
    n += count;
  }
  return all;
}

}  // namespace telekerf
