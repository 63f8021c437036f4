// SPDX-License-Identifier: Apache-2.0
// The seam of the codecs: how one axis of one block becomes bits, and samples again. What a stream is made of
// beyond that (heads, redundancy, order) is the same for all of them.
#pragma once

#include <span>

#include "common/codec/analysis.h"
#include "common/codec/axis_bits.h"
#include "common/codec/settings.h"

namespace telekerf::codec {

/// An axis as its encoder keeps it for the packets to come.
struct CodedAxis {
  AxisCode code;
  ShapeEnds ends;          ///< transforms only, as is
  Successor start;         ///< ... this
  double cost_bits = 0.0;  ///< ... and this: PricedCode
};

/// What an encoder has at hand.
struct EncoderTools {
  const StreamSettings& settings;
  const Grid& grid;
  const Analyser& analyser;
};

/// Functions without state, allocation or exceptions: they run in control loops, and `read` meets any bytes.
struct AxisCodec {
  CodecKind kind{};         ///< its number on the wire
  int min_block = 1;        ///< samples
  bool transforms = false;  ///< its packets announce a context model learnt from earlier blocks
  /// In the long run its stream costs no more than what `encode` gives with context.truncated: the encoder
  /// keeps account.
  bool bounded_by_truncation = false;
  double step_per_rms = 1.0;  ///< finest step of an adaptive stream, in units of its max_rms

  /// Codes `samples` and puts in their place what every receiver decodes.
  CodedAxis (*encode)(std::span<double> samples, const EncoderTools& tools,
                      const AxisContext& context) noexcept;
  void (*write)(BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid& grid,
                int block) noexcept;
  /// False when no encoder writes that. context.next is where the block that follows in time begins; `start`
  /// takes where this one does.
  bool (*read)(BitReader& in, const AxisContext& context, const Grid& grid, Successor& start,
               std::span<double> samples) noexcept;

  bool operator==(const AxisCodec&) const = default;
};

}  // namespace telekerf::codec
