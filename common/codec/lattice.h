// SPDX-License-Identifier: Apache-2.0
// The rivals in the time domain: differences with Rice codes, and dead-bands; one axis of one block at a
// time.
#pragma once

#include "common/codec/axis_code.h"
#include "common/codec/bits.h"
#include "common/codec/settings.h"

namespace telekerf::codec {

// Samples become integers of a uniform lattice, code.values x step, and every block begins with a whole one,
// so it decodes alone. kDpcm sends all of them as differences of order 0, 1 or 2 (what closed-loop prediction
// from the last decoded samples comes to on a lattice). The dead-band codecs send those in code.set, by run
// length and difference, and hold in between: kinder to them than the literature's whole floats.

/// The integers of `samples`; with settings.max_rms the coarsest step (widest band) whose RMS error stays
/// below it.
AxisCode analyse_lattice(std::span<const double> samples, const StreamSettings& settings,
                         const Grid& grid) noexcept;
void write_lattice(BitWriter& out, CodecKind kind, const AxisCode& code, int block) noexcept;
/// False when no encoder writes that.
bool read_lattice(BitReader& in, CodecKind kind, AxisCode& code, int block) noexcept;
/// The decoded samples.
void reconstruct_lattice(const AxisCode& code, const Grid& grid, std::span<double> samples) noexcept;

}  // namespace telekerf::codec
