// SPDX-License-Identifier: Apache-2.0
// How much of the planned power each place of a path gets, so that it burns evenly where beams overlap: at a
// sharp corner the spot burns the next leg while it is on this one.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "slave/machining/path.h"

namespace telekerf::machining {

/// Fractions of the planned power along a path with which every place gets the energy of a straight line:
/// Richardson and Lucy's deconvolution by the Gaussian spot.
class EvenBurn {
 public:
  /// From the path's start to `cut_end_m`. `overlap_m`: over which a closed path's end, which meets its
  /// start, fades out while the start fades in; 0: none.
  EvenBurn(const Path& path, double cut_end_m, double spot_radius_m, double overlap_m);

  double fraction(double arc_length_m) const noexcept;

 private:
  double weight(double distance_m) const noexcept;
  void find_neighbours();
  void even_out(const std::vector<double>& wanted);

  double step_m_, spot_radius_m_;
  std::vector<Vec2> places_;
  std::vector<double> fractions_;
  std::vector<std::vector<std::pair<std::uint32_t, double>>>
      near_;  ///< what of a place's light each one gets
};

}  // namespace telekerf::machining
