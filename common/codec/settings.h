// SPDX-License-Identifier: Apache-2.0
// How one stream of 3-axis samples is coded; everything a receiver needs of it travels in each packet.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace telekerf::codec {

/// What codes the samples. The values stand on the wire.
enum class CodecKind : std::uint8_t {
  kSdct = 0,  ///< selected discrete cosine transform (thesis 7.2.3)
  kRaw = 1,   ///< float32 samples
};

inline constexpr int kMaxRedundancy = 7;

/// One stream's settings, in the unit of its samples (m, N, m/s2).
struct StreamSettings {
  CodecKind kind = CodecKind::kSdct;
  int block = 16;        ///< samples a block, N: costs (N - 1) sample periods of latency
  int keep = 4;          ///< coefficients kept per axis and block, m (when max_rms is 0)
  double max_rms = 0.0;  ///< above 0: adaptive, every block and axis stays at or below this RMS error
  int redundancy =
      1;  ///< previous blocks repeated in each packet, R: a burst of R lost packets changes nothing
  double quantum = 5e-7;  ///< finest step of a coefficient; rounded down to a power of two
  std::uint32_t sample_period_ns = 1'000'000;
  bool anchored = true;  ///< each packet comes with the trend of its newest block (position streams)

  /// The settings, or a Refusal that names the setting, its value and its bound.
  StreamSettings validated() const;
};

/// "sdct", "raw" and so on: the same word on command lines, in configurations and in reports. Throws Refusal.
CodecKind codec_kind(const std::string& name);
const char* to_string(CodecKind kind) noexcept;
std::vector<std::string> codec_names();

}  // namespace telekerf::codec
