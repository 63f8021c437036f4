// SPDX-License-Identifier: Apache-2.0
// What a laser gave, by the clock: where, how long, and how each light ended. Nothing of it comes from
// whoever tells the laser.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/geometry/nearest.h"

namespace telekerf::plant {

/// How a light came to its end.
enum class DarkBy : std::uint8_t { kTold, kItself };

class LightBook {
 public:
  /// `radius_m`: of the workspace; what falls beyond is booked at its edge.
  explicit LightBook(double radius_m);

  /// A piece of light at one place, workpiece frame. `contour`: null while none is known; then, and beyond
  /// the corridor, it is outside. Pieces come in the order of time.
  void add(std::int64_t from_ns, std::int64_t to_ns, const Vec2& at_m, double power_w,
           const geometry::NearestIndex* contour);
  /// The light that was on is over. `after_ns`: from the last word that the laser obeyed to the dark.
  void dark(DarkBy by, std::int64_t after_ns) noexcept;

  double energy_j() const noexcept { return inside_j_ + outside_j_; }
  double outside_j() const noexcept { return outside_j_; }
  double dose_j() const noexcept { return dose_j_max_; }
  double dark_after_s() const noexcept { return 1e-9 * static_cast<double>(dark_after_ns_); }
  /// All of it; times in seconds of the clock that the pieces were told by.
  nlohmann::ordered_json report() const;

 private:
  static constexpr double kCell_m = 0.025e-3;
  static constexpr int kReach = 4;  ///< cells to 0.1 mm
  static constexpr std::size_t kMostLights = 20'000;

  struct Light {
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
    double energy_j = 0.0;
    DarkBy by = DarkBy::kTold;
  };

  void deposit(const Vec2& at_m, double energy_j);

  int side_;                   ///< cells
  std::vector<float> dose_j_;  ///< of each cell: what fell within 0.1 mm of it
  double dose_j_max_ = 0.0;
  double inside_j_ = 0.0;
  double outside_j_ = 0.0;
  std::int64_t dark_after_ns_ = 0;  ///< longest
  std::uint64_t by_itself_ = 0;
  std::uint64_t unkept_ = 0;  ///< lights for which there was no room
  bool lit_ = false;
  bool kept_ = false;  ///< the light that is on, or was last
  std::vector<Light> lights_;
};

}  // namespace telekerf::plant
