// SPDX-License-Identifier: Apache-2.0
// The same hand cuts the same contour twice, feeling nothing and feeling the cut: how deep it gets, and what
// the hand was given.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/remote/remote_motion.h"

namespace telekerf::experiments {

struct FeltCutTrial {
  std::string image = "heart";
  std::string netem = "thesis-constant";
  double beta = 0.5;
  double depth_mm = 0.5;
  double laser_w = 10.0;
  double hand_speed_mm_s = 20.0;
  double duration_s = 10.0;  ///< less than a round: no place is passed twice
};

struct FeltCutRun {
  bool felt = false;
  std::vector<RemoteSample> motion;
  RemoteMark mark;
  std::vector<double> time_s, given_j;  ///< to the hand at the tool: minus the work of the true force on it
  double depth_error = 0.0;   ///< rms of depth / wished depth - 1 at places lit, and lit on either side
  double marked_error = 0.0;  ///< and at all that are marked at all: the ends of stretches, too
  std::size_t lit_places = 0, marked_places = 0;
  double mean_depth_m = 0.0;
  double most_given_j = 0.0;  ///< largest of given_j
  double wished_rms_n = 0.0, felt_rms_n = 0.0;
  double held_back_share = 0.0;    ///< of the steps with the beam wanted: the force was not given whole
  double port_most_given_j = 0.0;  ///< by the felt force beyond the drag, as the station books it
  double tracking_rms_um = 0.0;
  double energy_outside_j = 0.0;
};

/// `heat_factor`: the true material needs that much more to be removed than the master's copy knows.
FeltCutRun run_felt_cut(const FeltCutTrial& trial, bool felt, std::uint64_t seed, double heat_factor = 1.0);

}  // namespace telekerf::experiments
