// SPDX-License-Identifier: Apache-2.0
// Bits a sample of every codec at equal RMS error, and the tables of docs/results/codec.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/reporting/page_tables.h"
#include "experiments/codec/codec_bound.h"
#include "experiments/codec/codec_traces.h"

namespace telekerf::experiments {

using Curve = std::vector<RatePoint>;

inline constexpr int kSweepFrom = -4, kSweepTo = 12;  ///< half octaves of the fine error

/// One way to code: constant step (every codec has one), or the promised RMS error of each block.
struct Contender {
  const char* label;
  const char* codec;
  bool promised = false;
  bool anchored = false;
  bool events = false;  ///< a packet of floats whenever a sample leaves the band: no block, no delay
  bool held = false;    ///< every 2nd, 4th or 8th sample (the best of them) by that codec, held in between
};
inline constexpr std::array<Contender, 9> kContenders{{
    {"SDCT", "sdct"},
    {"SDCT, promised RMS", "sdct", true},
    {"SDCT + anchor (not counted)", "sdct", false, true},
    {"truncated DCT", "truncated"},
    {"DPCM + Rice", "dpcm"},
    {"dead-band", "deadband"},
    {"Weber dead-band", "weber"},
    {"dead-band, floats at once", "deadband", false, false, true},
    {"held samples, DPCM + Rice", "dpcm", false, false, false, true},
}};

/// By RMS error, rising. Of blocks of `block` samples, each decoded alone.
Curve sweep(const SeededTrace& seeded, const Contender& contender, int block);

/// Bits at an error between two measured points, straight in log(error); NaN outside.
double bits_at(const Curve& curve, double rmse);

/// A line of the page's table: trace, its sensor's noise times this, samples a block.
struct RateRow {
  std::string trace;
  double factor;
  int block;
};
std::vector<RateRow> rate_rows();

/// The line's cells: what it is of, N, bits of SDCT, truncated DCT, DPCM, dead-band, and the Gaussian limit.
std::vector<std::string> rate_cells(const SeededTrace& seeded, const RateRow& row);

/// `rates`, of traces by name.
reporting::PageTable rates_table(const std::vector<SeededTrace>& traces);

}  // namespace telekerf::experiments
