// SPDX-License-Identifier: Apache-2.0
// From streamed positions to a motion: a least-squares parabola over a few neighbouring samples.
#pragma once

#include <optional>

#include "common/streaming/playout.h"
#include "slave/joiner.h"

namespace telekerf::slave {

/// Samples used to either side of the one that is applied.
inline constexpr int kHalfWindow = 4;

/// KinematicState at stream time `cursor` (samples; the nearest sample must be there, neighbours are used as
/// far as they are there without a gap and of the same generation). Position is the fit's value, so half a
/// count of noise averages out; velocity and acceleration are its derivatives. `period_s`: time between
/// samples.
std::optional<KinematicState> reference_at(const JitterBuffer& ring, double cursor, double period_s) noexcept;

/// Closes the gap around `index` of an anchored stream, where the samples on both sides are there, engaged
/// and of one generation: cubics through their states (of bare accelerations: straight lines), marked as
/// bridged. Nothing where the gap is longer than `reach` samples or the way over it would take more than
/// `most_m_per_s2`.
void bridge_gap(JitterBuffer& ring, std::int64_t index, double period_s, int reach,
                double most_m_per_s2) noexcept;

}  // namespace telekerf::slave
