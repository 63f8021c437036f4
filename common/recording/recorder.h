// SPDX-License-Identifier: Apache-2.0
// The rows of a run in virtual time, kept in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace telekerf {

/// Room is taken at the start; rows that find none are counted only.
template <typename Row>
class Recorder {
 public:
  explicit Recorder(std::size_t capacity) { rows_.reserve(capacity); }

  /// Wait-free, no allocation.
  void push(const Row& row) noexcept {
    if (rows_.size() == rows_.capacity()) {
      ++dropped_;
    } else {
      rows_.push_back(row);
    }
  }
  const std::vector<Row>& rows() const noexcept { return rows_; }
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  std::vector<Row> rows_;
  std::uint64_t dropped_ = 0;
};

}  // namespace telekerf
