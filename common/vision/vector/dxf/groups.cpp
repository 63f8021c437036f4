// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/dxf/groups.h"

#include <cmath>

#include "common/vision/vector/number.h"

namespace telekerf::vision {

std::optional<DxfGroup> DxfGroups::next() {
  if (text_.empty()) return std::nullopt;
  const std::string_view first = line();
  if (text_.empty() && first.empty()) return std::nullopt;
  std::string_view digits = first;
  const auto code = take_number(digits);
  damaged_ = !code || *code != std::floor(*code) || std::abs(*code) > 10000 || ended_;
  if (damaged_) return std::nullopt;
  return DxfGroup{static_cast<int>(*code), line()};
}

std::string_view DxfGroups::line() {
  ++lines_;
  const auto end = text_.find('\n');
  std::string_view out = text_.substr(0, end);
  if (end == std::string_view::npos) ended_ = true;
  text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
  while (!out.empty() && (out.back() == '\r' || out.back() == ' ' || out.back() == '\t'))
    out.remove_suffix(1);
  while (!out.empty() && (out.front() == ' ' || out.front() == '\t')) out.remove_prefix(1);
  return out;
}

}  // namespace telekerf::vision
