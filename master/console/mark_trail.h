// SPDX-License-Identifier: Apache-2.0
// Where the beam was on, for the page's growing mark: each place once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::master {

class MarkTrail {
 public:
  /// Metres, workpiece frame. What lies in a square of kGrid_m that is marked already changes nothing.
  void add(const Vec2& place_m);
  /// Another piece of work.
  void clear();
  /// Those from number `first` on, at most `count`.
  std::span<const Vec2> from(std::size_t first, std::size_t count) const;
  std::size_t size() const noexcept { return places_m_.size(); }
  /// Counts the pieces of work.
  std::uint32_t generation() const noexcept { return generation_; }

  static constexpr double kGrid_m = 40e-6;
  static constexpr std::size_t kMost = 200'000;  ///< 8 m of cut; what comes then is not shown

 private:
  std::vector<Vec2> places_m_;
  std::unordered_set<std::uint64_t> seen_;
  std::uint32_t generation_ = 0;
};

}  // namespace telekerf::master
