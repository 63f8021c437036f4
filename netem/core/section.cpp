// SPDX-License-Identifier: Apache-2.0
#include "netem/core/section.h"

#include <fmt/format.h>

#include <algorithm>

namespace telekerf::netem {

double Section::number(const std::string& key, double fallback, Bounds bounds) const {
  for (const std::string& name : names(key)) fallback = file_.number_or(name, fallback, bounds);
  return fallback;
}

double Section::number_or_none(const std::string& key, Bounds bounds) const {
  const double value = number(key, 0.0, {0.0, bounds.max});
  if (value != 0 && value < bounds.min) {
    refuse(key, fmt::format("must be 0 (none) or lie within [{:g}, {:g}]", bounds.min, bounds.max));
  }
  return value;
}

std::int64_t Section::integer(const std::string& key, std::int64_t fallback, Bounds bounds) const {
  for (const std::string& name : names(key)) fallback = file_.integer_or(name, fallback, bounds);
  return fallback;
}

bool Section::boolean(const std::string& key, bool fallback) const {
  for (const std::string& name : names(key)) fallback = file_.boolean_or(name, fallback);
  return fallback;
}

std::string Section::text(const std::string& key, std::string fallback) const {
  for (const std::string& name : names(key)) fallback = file_.text_or(name, fallback);
  return fallback;
}

std::vector<double> Section::numbers(const std::string& key, Bounds bounds) const {
  std::vector<double> values;
  for (const std::string& name : names(key)) {
    if (file_.has(name)) values = file_.numbers(name, 0, bounds);
  }
  return values;
}

std::string Section::word(const std::string& key, std::string fallback,
                          const std::vector<std::string>& words) const {
  for (const std::string& name : names(key)) fallback = file_.choice_or(name, fallback, words);
  return fallback;
}

const std::vector<std::size_t>& Section::holders(const std::string& key) const {
  Holders& known = holders_[key];
  for (; known.asked < tables_.size(); ++known.asked) {
    if (file_.has(tables_[known.asked] + key)) known.tables.push_back(known.asked);
  }
  return known.tables;
}

std::size_t Section::rank(const std::string& key) const {
  const auto& tables = holders(key);
  return tables.empty() ? tables_.size() : tables_.size() - 1 - tables.back();
}

void Section::refuse(const std::string& key, const std::string& complaint) const {
  const auto& tables = holders(key);
  file_.refuse(tables_[tables.empty() ? 0 : tables.back()] + key, complaint);
}

void Section::refuse_misplaced(const std::string& key, const std::string& selector,
                               const std::string& complaint) const {
  if (has(key) && rank(key) <= rank(selector)) refuse(key, complaint);
}

/// Where the key stands, the most general place first: the last two tables and the one that they override.
/// What lies below was read when it was the last.
std::vector<std::string> Section::names(const std::string& key) const {
  const auto& tables = holders(key);
  constexpr std::size_t kEnough = 3;
  std::vector<std::string> out;
  for (std::size_t i = tables.size() - std::min(tables.size(), kEnough); i < tables.size(); ++i)
    out.push_back(tables_[tables[i]] + key);
  return out;
}

}  // namespace telekerf::netem
