// SPDX-License-Identifier: Apache-2.0
// The bits of one axis of one block (docs/reference/packet.md has the fields).
#pragma once

#include "common/codec/axis_code.h"
#include "common/codec/bits.h"

namespace telekerf::codec {

/// What the stream has lately been like, announced in each packet's head so that the usual costs one bit.
struct ContextModel {
  int count = 4;        ///< coefficients an axis
  int step_offset = 0;  ///< half octaves above the finest step
  int level_order = 8;  ///< Exp-Golomb order of a level told whole
  int value_order = 4;  ///< ... of an axis' first coefficient
};

/// What both ends know before an axis is coded.
struct AxisContext {
  bool anchored = false;
  bool newest = true;
  bool adaptive = false;   ///< the step may differ from the stream's finest
  bool truncated = false;  ///< the predecessor: prefixes only, nothing predicted
  ContextModel habits;
  std::int64_t trend_level = 0;  ///< newest and anchored: the trend on the grid
  std::int64_t trend_slope = 0;
  Successor next;  ///< not newest: the block that follows
};

/// Counts what a BitWriter would write.
class BitCounter {
 public:
  void bits(std::uint64_t, int count) noexcept { count_ += count; }
  void golomb(std::uint64_t value, int order) noexcept { count_ += golomb_bits(value, order); }
  void signed_golomb(std::int64_t value, int order) noexcept { golomb(zigzag(value), order); }
  int count() const noexcept { return count_; }

 private:
  int count_ = 0;
};

/// `ends`: of the code's shape (used when not newest).
void write_axis(BitWriter& out, const AxisCode& code, const ShapeEnds& ends, const AxisContext& context,
                const Grid& grid, int block) noexcept;
/// The same, counted; newest block only.
int newest_axis_bits(const AxisCode& code, const AxisContext& context, const Grid& grid, int block) noexcept;

/// Reads an axis and its samples. False when the bits are none that an encoder writes.
bool read_axis(BitReader& in, AxisCode& code, const AxisContext& context, const Grid& grid, const Dct& dct,
               std::span<double> samples) noexcept;

/// The laser button, a bit a sample: constant, one change, or as it is.
void write_button(BitWriter& out, std::uint64_t button, int block) noexcept;
std::uint64_t read_button(BitReader& in, int block) noexcept;

}  // namespace telekerf::codec
