// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/even_burn.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>

#include "common/geometry/interpolation.h"

namespace telekerf::machining {
namespace {

constexpr std::ptrdiff_t kReach = 8;  ///< steps: two spot radii
constexpr int kRounds = 20;
constexpr double kMost = 1.25;  ///< beside a corner a little more evens out what the corner lacks

}  // namespace

EvenBurn::EvenBurn(const Path& path, double cut_end_m, double spot_radius_m, double overlap_m)
    : step_m_(0.25 * spot_radius_m), spot_radius_m_(spot_radius_m) {
  for (double arc = 0.0; arc <= cut_end_m; arc += step_m_) {
    places_.push_back(path.at(arc).position_m.head<2>());
    fractions_.push_back(overlap_m > 0.0 ? std::min({1.0, arc / overlap_m, (cut_end_m - arc) / overlap_m})
                                         : 1.0);
  }
  find_neighbours();
  // What a straight line gets; an open one's ends get less, which nothing should change.
  const auto count = static_cast<std::ptrdiff_t>(places_.size());
  std::vector<double> wanted(places_.size(), 0.0);
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    for (std::ptrdiff_t k = -kReach; k <= kReach; ++k) {
      if (path.closed() || (i + k >= 0 && i + k < count))
        wanted[static_cast<std::size_t>(i)] += weight(static_cast<double>(k) * step_m_);
    }
  }
  even_out(wanted);
}

void EvenBurn::even_out(const std::vector<double>& wanted) {
  std::vector<double> reach(places_.size(), 0.0), lack(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    for (const auto& [other, w] : near_[i]) reach[i] += w;
  }
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      double dose = 0.0;
      for (const auto& [other, w] : near_[i]) dose += w * fractions_[other];
      lack[i] = dose > 0.0 ? wanted[i] / dose : 1.0;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
      double more = 0.0;
      for (const auto& [other, w] : near_[i]) more += w * lack[other];
      fractions_[i] = std::min(kMost, fractions_[i] * more / reach[i]);
    }
  }
}

double EvenBurn::fraction(double arc_length_m) const noexcept {
  return geometry::interpolated(fractions_, arc_length_m / step_m_);
}

double EvenBurn::weight(double distance_m) const noexcept {
  const double r = distance_m / spot_radius_m_;
  return r < 2.0 + 1e-9 ? std::exp(-2.0 * r * r) : 0.0;
}

/// By squares of two spot radii, so that the work grows with the path's length only.
void EvenBurn::find_neighbours() {
  const double cell = 2.0 * spot_radius_m_;
  const auto key = [&](const Vec2& p, int dx, int dy) {
    const auto x = static_cast<std::int64_t>(std::floor(p.x() / cell)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(p.y() / cell)) + dy;
    return (x << 32) ^ (y & 0xffffffff);
  };
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells;
  for (std::size_t i = 0; i < places_.size(); ++i)
    cells[key(places_[i], 0, 0)].push_back(static_cast<std::uint32_t>(i));
  near_.resize(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = cells.find(key(places_[i], dx, dy));
        if (found == cells.end()) continue;
        for (const std::uint32_t other : found->second) {
          const double w = weight((places_[other] - places_[i]).norm());
          if (w > 0.0) near_[i].emplace_back(other, w);
        }
      }
    }
  }
}

}  // namespace telekerf::machining
