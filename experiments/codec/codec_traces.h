// SPDX-License-Identifier: Apache-2.0
// Seeded signals of teleoperation, to hold codecs against: same seed, same numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "common/codec/baselines/trace.h"

namespace telekerf::experiments {

/// A trace and what it stands for.
struct SeededTrace {
  codec::Trace trace;  ///< three columns
  const char* unit;    ///< of its samples
  double fine;         ///< RMS error that is about its sensor's noise or step
  bool is_position;
};

/// hand: 25 mm sd wander, 9 Hz tremor of 50 um, encoder step 0.5 um. contour: a hand-guided round of a star
/// at 10 mm/s, encoder step 1 um. force: contact of 5 N, chatter, 3 mN noise. acceleration: of the hand, with
/// sensor noise. chirp: 1 to 200 Hz. steps: jumps at random times (torture). held: the hand at 50 Hz, held in
/// between. noise: white. Likenesses of what others record, three times as long and at their own rates:
/// joints of a robot (100 Hz, places to go to), a pen on a tablet (125 Hz), an electrocardiogram (360 Hz),
/// motor currents with friction and ripple (1 kHz), contact that begins and ends hard (1 kHz).
std::vector<SeededTrace> seeded_traces(double seconds, double rate_hz, std::uint64_t seed);

}  // namespace telekerf::experiments
