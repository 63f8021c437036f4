// SPDX-License-Identifier: Apache-2.0
// The predecessor of the SDCT (thesis 7.2.3): the lowest coefficients of the transform, nothing predicted.
#pragma once

#include "common/codec/sdct.h"

namespace telekerf::codec {

inline constexpr CodecKind kTruncatedDct{2};
extern const AxisCodec kTruncatedDctCodec;

}  // namespace telekerf::codec
