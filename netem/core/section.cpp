// SPDX-License-Identifier: Apache-2.0
#include "netem/core/section.h"

#include <fmt/format.h>

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

std::size_t Section::rank(const std::string& key) const {
  std::size_t i = 0;
  while (i < tables_.size() && !file_.has(tables_[i] + key)) ++i;
  return i;
}

void Section::refuse(const std::string& key, const std::string& complaint) const {
  file_.refuse(tables_[has(key) ? rank(key) : tables_.size() - 1] + key, complaint);
}

void Section::refuse_misplaced(const std::string& key, const std::string& selector,
                               const std::string& complaint) const {
  if (has(key) && rank(key) <= rank(selector)) refuse(key, complaint);
}

/// The key in every table, the most general one first.
std::vector<std::string> Section::names(const std::string& key) const {
  std::vector<std::string> out;
  for (auto table = tables_.rbegin(); table != tables_.rend(); ++table) out.push_back(*table + key);
  return out;
}

}  // namespace telekerf::netem
