// SPDX-License-Identifier: Apache-2.0
// The codecs there are: the one place of the library that knows the baselines. Another one is its own header
// and source, a row here and a test.
#pragma once

#include "common/codec/baselines/deadband.h"
#include "common/codec/baselines/dpcm.h"
#include "common/codec/baselines/raw.h"
#include "common/codec/baselines/truncated_dct.h"
#include "common/codec/sdct.h"
#include "common/runtime/enum_table.h"

namespace telekerf::codec {

/// What a user's word stands for.
struct CodecChoice {
  const AxisCodec* codec = nullptr;
  bool sample_by_sample = false;  ///< one sample a packet: block 1, redundancy 0
  bool operator==(const CodecChoice&) const = default;
};

inline constexpr EnumRow<CodecChoice> kCodecRows[] = {
    {"raw", {&kRawCodec, true}, "one float32 sample a packet: no block, no copies"},
    {"sdct", {&kSdctCodec}, "selected discrete cosine transform"},
    {"batched", {&kRawCodec}, "float32 samples in blocks"},
    {"truncated", {&kTruncatedDctCodec}, "the transform's lowest coefficients, nothing predicted"},
    {"deadband", {&kDeadbandCodec}, "a sample when the signal has left the last one sent"},
    {"weber", {&kWeberCodec}, "the same by a fraction of the last one sent"},
    {"dpcm", {&kDpcmCodec}, "differences of neighbouring samples"},
};
inline constexpr EnumTable<CodecChoice> kCodecs{kCodecRows};

/// The codec of that number on the wire; null: there is none.
inline const AxisCodec* find_codec(CodecKind kind) noexcept {
  for (const auto& row : kCodecRows) {
    if (row.value.codec->kind == kind) return row.value.codec;
  }
  return nullptr;
}

}  // namespace telekerf::codec
