// SPDX-License-Identifier: Apache-2.0
// Dead-bands: a sample goes out when it has left the last one sent by more than a threshold, absolute or
// (Weber) a fraction of it, and is held in between. Told by run length and difference: kinder to them than
// the literature's whole floats.
#pragma once

#include "common/codec/axis_codec.h"

namespace telekerf::codec {

inline constexpr CodecKind kDeadband{3};  ///< settings.threshold
inline constexpr CodecKind kWeber{4};     ///< settings.threshold x |last one sent|
extern const AxisCodec kDeadbandCodec;
extern const AxisCodec kWeberCodec;

}  // namespace telekerf::codec
