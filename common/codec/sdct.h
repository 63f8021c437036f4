// SPDX-License-Identifier: Apache-2.0
// The selected discrete cosine transform (thesis 7.2.3) as a codec of an axis.
#pragma once

#include "common/codec/axis_codec.h"

namespace telekerf::codec {

// Also what its predecessor is made of (baselines/truncated_dct.h), with context.truncated.
CodedAxis encode_sdct(std::span<double> samples, const EncoderTools& tools,
                      const AxisContext& context) noexcept;
void write_sdct(BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid& grid,
                int block) noexcept;
bool read_sdct(BitReader& in, const AxisContext& context, const Grid& grid, Successor& start,
               std::span<double> samples) noexcept;

/// A transform's rounding is at most half a step in each coefficient, so a step of 2 epsilon always keeps
/// epsilon.
inline constexpr double kTransformStepPerRms = 2.0;

inline constexpr AxisCodec kSdctCodec{.kind = kSdct,
                                      .min_block = kMinTransform,
                                      .transforms = true,
                                      .bounded_by_truncation = true,
                                      .step_per_rms = kTransformStepPerRms,
                                      .encode = encode_sdct,
                                      .write = write_sdct,
                                      .read = read_sdct};

}  // namespace telekerf::codec
