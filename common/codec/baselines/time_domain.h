// SPDX-License-Identifier: Apache-2.0
// What the codecs in the time domain share: samples become whole multiples of a step, and every block begins
// with a whole one, so that it decodes alone. On the wire an axis is one bit (raw?), in an adaptive stream
// its step, and a body that the codec knows.
#pragma once

#include <numbers>
#include <span>

#include "common/codec/axis_codec.h"
#include "common/codec/raw_samples.h"

namespace telekerf::codec {

/// An adaptive stream tries up to four half octaves above its finest step: sqrt(12) epsilon.
inline constexpr double kTimeDomainStepPerRms = 0.5 * std::numbers::sqrt3;
inline constexpr int kFirstOrder = 10;  ///< Exp-Golomb order of a block's first, whole integer

/// Squared error that a block may have; a hair below what settings.max_rms promises, so that rounding in the
/// sums cannot break it.
double allowed_energy(std::span<const double> samples, const StreamSettings& settings) noexcept;
/// The decoded samples: multiples of the step.
void reconstruct_multiples(const AxisCode& code, const Grid& grid, std::span<double> samples) noexcept;

template <typename Sink, typename WriteBody>
void write_multiples(Sink& out, const AxisCode& code, bool adaptive, int block,
                     const WriteBody& write_body) noexcept {
  out.bits(code.mode == Mode::kRaw ? 1 : 0, 1);
  if (code.mode == Mode::kRaw) return write_raw_samples(out, code, block);
  if (adaptive) out.golomb(static_cast<std::uint64_t>(code.step_offset), 0);
  write_body(out, code, block);
}

/// `code` in an axis of its own and decoded in place of `samples`; raw ones unless it has `kept` its promise
/// and is no longer than they are.
template <typename WriteBody>
CodedAxis coded_or_raw(const AxisCode& code, bool kept, std::span<double> samples, const EncoderTools& tools,
                       const WriteBody& write_body) noexcept {
  const auto block = static_cast<int>(samples.size());
  BitCounter counter;
  write_multiples(counter, code, tools.settings.max_rms > 0.0, block, write_body);
  CodedAxis axis;
  if (kept && counter.count() <= kRawSampleBits * block) {
    axis.code = code;
    reconstruct_multiples(code, tools.grid, samples);
  } else {
    axis.code = raw_code(samples);
    reconstruct(axis.code, tools.grid, {}, samples);
  }
  return axis;
}

template <typename ReadBody>
bool read_multiples(BitReader& in, bool adaptive, const Grid& grid, std::span<double> samples,
                    const ReadBody& read_body) noexcept {
  if (in.bit()) return read_raw_samples(in, samples);
  AxisCode code;
  const auto offset = adaptive ? in.golomb(0) : 0;
  if (in.failed() || offset > kMaxStepOffset) return false;
  code.step_offset = static_cast<int>(offset);
  if (!read_body(in, code, static_cast<int>(samples.size()))) return false;
  reconstruct_multiples(code, grid, samples);
  return true;
}

}  // namespace telekerf::codec
