// SPDX-License-Identifier: Apache-2.0
// The codecs there are: the one place of the library that knows the baselines. Another one is its own header
// and source, a row here and a test.
#pragma once

#include <string>
#include <vector>

#include "common/codec/baselines/deadband.h"
#include "common/codec/baselines/dpcm.h"
#include "common/codec/baselines/raw.h"
#include "common/codec/baselines/truncated_dct.h"
#include "common/codec/sdct.h"
#include "common/codec/settings.h"
#include "common/runtime/enum_table.h"
#include "common/runtime/settings.h"

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

inline constexpr CodecChoice kDefaultCodec{&kSdctCodec};

/// `settings` with that codec. Sample by sample: block 1 and redundancy 0.
StreamSettings with_codec(StreamSettings settings, const CodecChoice& choice);

/// What the chosen codec does not read is refused: block and redundancy, and keep and max_rms of each signal,
/// whose name stands before them ("", "force_"); all of them are declared, and codec as well.
void refuse_unread(Settings& settings, const std::vector<std::string>& signals);

/// The codec of that number on the wire; null: there is none.
inline const AxisCodec* find_codec(CodecKind kind) noexcept {
  for (const auto& row : kCodecRows) {
    if (row.value.codec->kind == kind) return row.value.codec;
  }
  return nullptr;
}

}  // namespace telekerf::codec
