// SPDX-License-Identifier: Apache-2.0
// The emulator proves itself: many virtual packets, measured against the nominal law, with bounds that a
// correct emulator leaves less than once in a million verifications.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "netem/profile.h"
#include "netem/random.h"

namespace telekerf::netem {

/// One measured quantity. `judged` is false where there is no nominal value to hold it against.
struct Check {
  std::string name;
  std::string unit;
  double measured = 0.0;
  double nominal = 0.0;
  double low = 0.0, high = 0.0;
  bool judged = true;
  bool good() const { return !judged || (measured >= low && measured <= high); }
};

struct VerifyOptions {
  std::uint64_t packets = 1'000'000;
  std::uint64_t seed = 1;
  double rate_hz = 1000.0;
  std::uint32_t packet_bytes = 200;
};

/// One stage of one direction.
struct StageReport {
  Direction direction = Direction::kForward;
  double from_s = 0.0;
  std::vector<Check> checks;
  bool good() const;
};

/// Sends packets through an emulator of `emulated` and holds every impairment against the nominal law of
/// `nominal`; the two differ only in tests of this function. Each stage is measured on its own, over all
/// packets.
std::vector<StageReport> verify_direction(const DirectionProfile& nominal, const DirectionProfile& emulated,
                                          Direction direction, const VerifyOptions& options);

/// Both directions.
std::vector<StageReport> verify(const Profile& profile, const VerifyOptions& options);

}  // namespace telekerf::netem
