// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/unsupported_elements.h"

#include <fmt/format.h>

#include <algorithm>

namespace telekerf::vision {
namespace {

constexpr std::size_t kMaxNames = 12;
constexpr std::size_t kMaxLength = 40;

}  // namespace

void UnsupportedElements::add(std::string_view name, std::size_t times) {
  std::string key(name.substr(0, kMaxLength));
  std::replace_if(
      key.begin(), key.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  const bool known = counts_.contains(key);
  counts_[known || counts_.size() < kMaxNames ? key : "others"] += times;
}

std::string UnsupportedElements::sentence() const {
  std::string out;
  for (const auto& [name, times] : counts_)
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", times, name);
  return out;
}

}  // namespace telekerf::vision
