// SPDX-License-Identifier: Apache-2.0
// What a vector file holds that is not followed: never silently.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace telekerf::vision {

/// How often, by its name in the file; anything but printable ASCII in a name is a question mark.
class UnsupportedElements {
 public:
  void add(std::string_view name, std::size_t times = 1);
  bool empty() const { return counts_.empty(); }
  /// "2 text, 1 image"
  std::string sentence() const;

 private:
  std::map<std::string, std::size_t> counts_;
};

}  // namespace telekerf::vision
