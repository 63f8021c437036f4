// SPDX-License-Identifier: Apache-2.0
// No codec at all: float32 samples, one by one or in blocks.
#pragma once

#include "common/codec/axis_codec.h"

namespace telekerf::codec {

inline constexpr CodecKind kRaw{1};
extern const AxisCodec kRawCodec;

}  // namespace telekerf::codec
