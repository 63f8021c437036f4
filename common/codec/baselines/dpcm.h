// SPDX-License-Identifier: Apache-2.0
// Differences of order 0, 1 or 2 with Rice codes: what closed-loop prediction from the last decoded samples
// comes to when samples are whole multiples of a step.
#pragma once

#include "common/codec/axis_codec.h"

namespace telekerf::codec {

inline constexpr CodecKind kDpcm{5};
extern const AxisCodec kDpcmCodec;

}  // namespace telekerf::codec
