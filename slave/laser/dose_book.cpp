// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/dose_book.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace telekerf::laser {

DoseBook::DoseBook(double radius_m)
    : origin_m_(-kTile_m * (std::ceil(radius_m / kTile_m) + 1.0)),
      side_(2 * static_cast<int>(std::lround(-origin_m_ / kTile_m))),
      table_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), -1) {
  const double around_m = radius_m + 2.0 * kTile_m;
  const double all = std::numbers::pi * around_m * around_m / (kTile_m * kTile_m);
  tiles_.resize(std::min(kMaxTiles, static_cast<std::size_t>(std::ceil(all))));
}

template <class F>
bool DoseBook::rows(const Vec2& place_m, F f) const noexcept {
  const double x = (place_m.x() - origin_m_) / kCell_m;
  const double y = (place_m.y() - origin_m_) / kCell_m;
  constexpr double kReach = kRadius_m / kCell_m;
  const double last = static_cast<double>(side_ * kCellsOfATile) - 1.0;
  // Written so that a NaN is beyond.
  if (!(x - kReach >= 0.0 && y - kReach >= 0.0 && x + kReach <= last && y + kReach <= last)) return false;
  const int from_y = static_cast<int>(y - kReach);
  const int to_y = static_cast<int>(y + kReach);
  for (int row = from_y; row <= to_y; ++row) {
    // From the place to the nearest point of the row.
    const double off = std::max({0.0, row - y, y - (row + 1)});
    const double half = std::sqrt(std::max(0.0, kReach * kReach - off * off));
    f(static_cast<int>(x - half), static_cast<int>(x + half), row);
  }
  return true;
}

DoseBook::Dose DoseBook::at(const Vec2& place_m) const noexcept {
  float most = 0.0F;
  bool room = true;
  const bool within = rows(place_m, [&](int from, int to, int row) noexcept {
    for (int column = from; column <= to; ++column) {
      const std::int32_t n = table_[entry(column / kCellsOfATile, row / kCellsOfATile)];
      if (n < 0) {
        room = room && taken_ + 4 <= tiles_.size();  // a disc lies on four tiles at most
        column += kCellsOfATile - 1 - column % kCellsOfATile;
        continue;
      }
      const Tile& tile = tiles_[static_cast<std::size_t>(n)];
      most = std::max(most, tile.cells_j[row % kCellsOfATile][column % kCellsOfATile]);
    }
  });
  if (!within || !room) return {};
  const int tile_x = static_cast<int>((place_m.x() - origin_m_) / kTile_m);
  const int tile_y = static_cast<int>((place_m.y() - origin_m_) / kTile_m);
  const std::int32_t n = table_[entry(tile_x, tile_y)];
  const double sum_j = n < 0 ? 0.0 : static_cast<double>(tiles_[static_cast<std::size_t>(n)].sum_j);
  return {static_cast<double>(most), sum_j, true};
}

DoseBook::Tile* DoseBook::take(int tile_x, int tile_y) noexcept {
  std::int32_t& n = table_[entry(tile_x, tile_y)];
  if (n < 0) {
    if (taken_ == tiles_.size()) return nullptr;
    n = static_cast<std::int32_t>(taken_++);
    tiles_[static_cast<std::size_t>(n)] = {};
  }
  return &tiles_[static_cast<std::size_t>(n)];
}

void DoseBook::add(const Vec2& place_m, double energy_j) noexcept {
  if (!(energy_j > 0.0) || !std::isfinite(energy_j)) return;
  bool room = true;
  const bool within = rows(place_m, [&](int from, int to, int row) noexcept {
    for (int column = from; column <= to; ++column) {
      Tile* const tile = take(column / kCellsOfATile, row / kCellsOfATile);
      room = room && tile != nullptr;
      if (tile == nullptr) return;
      tile->cells_j[row % kCellsOfATile][column % kCellsOfATile] += static_cast<float>(energy_j);
    }
  });
  if (!within || !room) {
    unkept_j_ += energy_j;
    return;
  }
  const int tile_x = static_cast<int>((place_m.x() - origin_m_) / kTile_m);
  const int tile_y = static_cast<int>((place_m.y() - origin_m_) / kTile_m);
  take(tile_x, tile_y)->sum_j += static_cast<float>(energy_j);
}

void DoseBook::clear() noexcept {
  std::fill(table_.begin(), table_.end(), -1);
  taken_ = 0;
  unkept_j_ = 0.0;
}

}  // namespace telekerf::laser
