// SPDX-License-Identifier: Apache-2.0
// The bits of one axis of one block (docs/reference/packet.md has the fields).
#pragma once

#include "common/codec/axis_code.h"
#include "common/codec/bits.h"
#include "common/codec/context_model.h"

namespace telekerf::codec {

/// What both ends know before an axis is coded.
struct AxisContext {
  bool anchored = false;
  bool newest = true;
  bool adaptive = false;   ///< the step may differ from the stream's finest
  bool truncated = false;  ///< the predecessor: prefixes only, nothing predicted
  ContextModel model;
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

}  // namespace telekerf::codec
