// SPDX-License-Identifier: Apache-2.0
// The rivals in the time domain: differences with Rice codes, and dead-bands; one axis of one block at a
// time.
#pragma once

#include "common/codec/axis_bits.h"
#include "common/codec/axis_code.h"
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
/// How its bits are to be read.
struct LatticeKind {
  CodecKind codec = CodecKind::kDpcm;
  bool adaptive = false;  ///< the step may differ from the stream's finest
};
void write_lattice(BitWriter& out, const LatticeKind& kind, const AxisCode& code, int block) noexcept;
/// False when no encoder writes that.
bool read_lattice(BitReader& in, const LatticeKind& kind, AxisCode& code, int block) noexcept;
/// Rounds to the lattice what left the last one kept by more than `band` and holds it in between, into
/// code.values and code.set; returns the squared error.
double hold_within(std::span<const double> samples, double band, double step, AxisCode& code) noexcept;
/// Changes of code.values after its first: how many, run lengths, steps. The first value is the caller's.
void write_runs(BitWriter& out, const AxisCode& code) noexcept;
void write_runs(BitCounter& out, const AxisCode& code) noexcept;
/// The values from values[0] on; false when no encoder writes that.
bool read_runs(BitReader& in, AxisCode& code, int block) noexcept;

/// The decoded samples.
void reconstruct_lattice(const AxisCode& code, const Grid& grid, std::span<double> samples) noexcept;

}  // namespace telekerf::codec
