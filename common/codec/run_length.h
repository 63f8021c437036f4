// SPDX-License-Identifier: Apache-2.0
// Values that are held from sample to sample, told by run length and difference: jumps and held signals.
#pragma once

#include <cmath>
#include <span>

#include "common/codec/axis_bits.h"
#include "common/codec/axis_code.h"
#include "common/codec/bits.h"

namespace telekerf::codec {

/// How far a signal may leave the value last kept before another one is: `absolute` + `relative` x |that
/// value|.
struct Band {
  double absolute = 0.0;
  double relative = 0.0;
};

/// Rounds to multiples of `step` what leaves the last value kept by more than the band, and holds it in
/// between: code.values of every sample, code.set where they change. Returns the squared error.
double hold_within(std::span<const double> samples, const Band& band, double step, AxisCode& code) noexcept;

/// Changes of code.values after its first: how many, run lengths, steps. The first value is the caller's.
void write_runs(BitWriter& out, const AxisCode& code) noexcept;
void write_runs(BitCounter& out, const AxisCode& code) noexcept;
/// The values from values[0] on; false when no encoder writes that.
bool read_runs(BitReader& in, AxisCode& code, int block) noexcept;

}  // namespace telekerf::codec
