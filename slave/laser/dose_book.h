// SPDX-License-Identifier: Apache-2.0
// How much energy each place of the workpiece has got, so that no place gets too much whatever arrives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::laser {

/// Raster over the workspace, workpiece frame. A cell holds the energy of every exposure from which it is
/// kRadius_m away or less, so that no disc of that radius, wherever its centre lies within the cell, has got
/// more. Its memory is taken at the beginning; nothing else allocates.
class DoseBook {
 public:
  /// 0.1 mm, and what sensors and one step's way add.
  static constexpr double kRadius_m = 0.11e-3;
  static constexpr double kCell_m = 0.05e-3;
  static constexpr double kTile_m = 1e-3;

  /// `radius_m`: of the workspace.
  explicit DoseBook(double radius_m);

  struct Dose {
    double place_j = 0.0;         ///< most within kRadius_m of any place within kRadius_m of this one
    double area_j_per_mm2 = 0.0;  ///< mean over the raster's square millimetre
    bool kept = false;            ///< false: beyond the raster, or its memory is used up
  };
  /// So far.
  Dose at(const Vec2& place_m) const noexcept;
  /// `energy_j` was given at `place_m`; what is not a positive number is left out, what is not kept is
  /// counted.
  void add(const Vec2& place_m, double energy_j) noexcept;
  /// Another workpiece: nothing has got anything. As long as the raster's table is: tens of microseconds.
  void clear() noexcept;

  /// J that were given where nobody keeps account.
  double unkept_j() const noexcept { return unkept_j_; }

 private:
  static constexpr int kCellsOfATile = 20;
  struct Tile {
    float cells_j[kCellsOfATile][kCellsOfATile];
    float sum_j;
  };
  static constexpr std::size_t kMaxTiles = 4096;

  /// Cells about a place, row by row: f(cell x from, to, cell y).
  template <class F>
  bool rows(const Vec2& place_m, F f) const noexcept;
  std::size_t entry(int tile_x, int tile_y) const noexcept {
    return static_cast<std::size_t>(tile_y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(tile_x);
  }
  /// Null: all are taken.
  Tile* take(int tile_x, int tile_y) noexcept;

  double origin_m_;                  ///< of the raster's first cell, along x and y alike
  int side_;                         ///< tiles
  std::vector<std::int32_t> table_;  ///< of tiles; negative: none yet
  std::vector<Tile> tiles_;
  std::size_t taken_ = 0;
  double unkept_j_ = 0.0;
};

}  // namespace telekerf::laser
