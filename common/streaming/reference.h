// SPDX-License-Identifier: Apache-2.0
// From streamed positions to a motion: a least-squares parabola over a few neighbouring samples.
#pragma once

#include <optional>

#include "common/streaming/jitter_buffer.h"

namespace telekerf::streaming {

/// Samples used to either side of the one that is applied.
inline constexpr int kHalfWindow = 4;

/// KinematicState at stream time `cursor` (samples; the nearest sample must be there, neighbours are used as
/// far as they are there without a gap and of the same generation). Position is the fit's value, so half a
/// count of noise averages out; velocity and acceleration are its derivatives. `period_s`: time between
/// samples.
std::optional<KinematicState> reference_at(const JitterBuffer& buffer, double cursor,
                                           double period_s) noexcept;

}  // namespace telekerf::streaming
