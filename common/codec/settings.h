// SPDX-License-Identifier: Apache-2.0
// How one stream of 3-axis samples is coded; everything a receiver needs of it travels in each packet.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace telekerf::codec {

/// What codes the samples: a number that stands on the wire. Each codec's header names its own, codec_table.h
/// has them all.
enum class CodecKind : std::uint8_t {};
inline constexpr CodecKind kSdct{0};

inline constexpr int kMaxRedundancy = 7;

/// One stream's settings, in the unit of its samples (m, N, m/s2).
struct StreamSettings {
  CodecKind kind = kSdct;
  int block = 16;         ///< samples a block, N: costs (N - 1) sample periods of latency
  int keep = 4;           ///< coefficients kept per axis and block, m (when max_rms is 0)
  double max_rms = 0.0;   ///< above 0: adaptive, every block and axis stays at or below this RMS error
  int redundancy = 1;     ///< previous blocks in each packet, R: a burst of R lost packets changes nothing
  double quantum = 5e-7;  ///< finest step of coefficients or samples; rounded down to a quarter octave
  /// The receiver integrates the samples twice (accelerations): without max_rms, the coefficients are chosen
  /// by what they do to the integral.
  bool integrated = false;
  double threshold = 0;  ///< of the dead-band codecs (without max_rms): absolute, or Weber's fraction
  std::uint32_t sample_period_ns = 1'000'000;
  int axes = 3;          ///< coded components of each Vec3; the others decode to zero
  bool anchored = true;  ///< each packet comes with the trend of its newest block (position streams)

  /// The settings, or a StartupError that names the setting, its value and its bound.
  StreamSettings validated() const;
};

/// `settings` with the codec of that name: "sdct", "raw" (one float32 sample a packet: block 1, redundancy
/// 0), "batched" (float32 in blocks), "truncated", "deadband", "weber", "dpcm". The same words everywhere.
/// Throws StartupError.
StreamSettings with_codec(StreamSettings settings, const std::string& name);
std::vector<std::string> codec_names();

}  // namespace telekerf::codec
