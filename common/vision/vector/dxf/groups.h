// SPDX-License-Identifier: Apache-2.0
// A DXF file as it is written: pairs of lines.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace telekerf::vision {

/// One pair of lines: a group code and its value, without blanks around it.
struct DxfGroup {
  int code = 0;
  std::string_view value;
};

/// The groups of a text, one after the other.
class DxfGroups {
 public:
  /// `line` is where the text begins in its file.
  explicit DxfGroups(std::string_view text, std::size_t line = 0) : text_(text), lines_(line) {}

  /// Nothing at the end, or where the file is `damaged`.
  std::optional<DxfGroup> next();
  bool damaged() const { return damaged_; }
  std::size_t line_number() const { return lines_; }
  std::string_view rest() const { return text_; }  ///< what is not read yet

 private:
  std::string_view line();

  std::string_view text_;
  std::size_t lines_;
  bool ended_ = false;
  bool damaged_ = false;
};

}  // namespace telekerf::vision
