// SPDX-License-Identifier: Apache-2.0
#include "master/console/mark_trail.h"

#include <algorithm>
#include <cmath>

namespace telekerf::master {

void MarkTrail::add(const Vec2& place_m) {
  constexpr double kFarthest_m = 100.0;
  if (places_m_.size() >= kMost || !(place_m.norm() < kFarthest_m)) return;
  const auto cell = [](double m) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(m / kGrid_m)));
  };
  if (seen_.insert(std::uint64_t{cell(place_m.x())} << 32U | cell(place_m.y())).second)
    places_m_.push_back(place_m);
}

void MarkTrail::clear() {
  places_m_.clear();
  seen_.clear();
  ++generation_;
}

std::span<const Vec2> MarkTrail::from(std::size_t first, std::size_t count) const {
  first = std::min(first, places_m_.size());
  return std::span(places_m_).subspan(first, std::min(count, places_m_.size() - first));
}

}  // namespace telekerf::master
