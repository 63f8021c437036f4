// SPDX-License-Identifier: Apache-2.0
// The emulator proves itself: many virtual packets, measured against the nominal law, with bounds that a
// correct emulator leaves less than once in a million verifications.
#pragma once

#include <vector>

#include "netem/core/profile.h"
#include "netem/core/random.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// One stage of one direction.
struct StageReport {
  Direction direction = Direction::kForward;
  double from_s = 0.0;
  std::vector<Check> checks;
  bool good() const;
};

/// Sends the traffic through an emulator of `emulated` and holds every impairment against the nominal law of
/// `nominal`; the two differ only in tests of this function. Each stage is measured on its own, over all
/// packets.
std::vector<StageReport> verify_direction(const DirectionProfile& nominal, const DirectionProfile& emulated,
                                          Direction direction, const Traffic& traffic);

/// Both directions.
std::vector<StageReport> verify(const Profile& profile, const Traffic& traffic);

}  // namespace telekerf::netem
