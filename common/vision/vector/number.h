// SPDX-License-Identifier: Apache-2.0
// Numbers in the loose notation of vector files, independent of any locale.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace telekerf::vision {

/// Drops blanks and commas.
inline void skip_separators(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == '\n' ||
                           text.front() == '\r' || text.front() == '\f' || text.front() == ',')) {
    text.remove_prefix(1);
  }
}

/// Takes one finite number off the front; nothing is taken when there is none.
inline std::optional<double> take_number(std::string_view& text) {
  skip_separators(text);
  std::string_view rest = text;
  if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  text = rest;
  return value;
}

/// An arc's flag is a single digit that may touch what follows ("a1 1 0 0110 10").
inline std::optional<bool> take_flag(std::string_view& text) {
  skip_separators(text);
  if (text.empty() || (text.front() != '0' && text.front() != '1')) return std::nullopt;
  const bool flag = text.front() == '1';
  text.remove_prefix(1);
  return flag;
}

}  // namespace telekerf::vision
