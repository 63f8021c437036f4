// SPDX-License-Identifier: Apache-2.0
// What a vector file holds that is not followed: never silently.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace telekerf::vision {

/// How often, by its name in the file; anything but printable ASCII in a name is a question mark.
class UnsupportedElements {
 public:
  void add(std::string_view name, std::size_t times = 1) {
    std::string key(name.substr(0, 40));
    std::replace_if(
        key.begin(), key.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    const bool known = counts_.contains(key);
    counts_[known || counts_.size() < kMostNames ? key : "others"] += times;
  }
  bool empty() const { return counts_.empty(); }
  std::size_t of(const std::string& name) const { return counts_.contains(name) ? counts_.at(name) : 0; }
  /// "2 text, 1 image"
  std::string sentence() const {
    std::string out;
    for (const auto& [name, times] : counts_)
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", times, name);
    return out;
  }

 private:
  static constexpr std::size_t kMostNames = 12;
  std::map<std::string, std::size_t> counts_;
};

}  // namespace telekerf::vision
