// SPDX-License-Identifier: Apache-2.0
#include "common/codec/encoder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/codec/button_bits.h"
#include "common/codec/codec_table.h"
#include "common/codec/context_model.h"

namespace telekerf::codec {
namespace {

/// Adaptive streams derive their finest step from the promise.
int quantum_exponent_of(const StreamSettings& settings, const AxisCodec& codec) {
  const double finest = settings.max_rms > 0.0 ? codec.step_per_rms * settings.max_rms : settings.quantum;
  return std::clamp(static_cast<int>(std::floor(4.0 * std::log2(finest))), -kMaxQuantumExponent,
                    kMaxQuantumExponent);
}

/// The three axes of a block: their codes, and the samples that every receiver decodes.
struct CodedSamples {
  std::array<CodedAxis, kAxes> axes;
  std::array<Vec3, kMaxBlock> decoded;
};

/// A block that is kept for the packets to come.
struct Block : CodedSamples {
  std::uint64_t button = 0;
};

/// A stream that has spared more than this is trusted no longer for it, bits.
constexpr double kMostSpared = 64.0;

/// The same samples by truncation alone, as if the stream had never known anything else.
struct Truncation {
  ContextModel model;
  CodedSamples coded;
  double spared_bits = 0.0;  ///< by which the stream has been cheaper so far
};

}  // namespace

struct BlockEncoder::State {
  explicit State(const StreamSettings& wanted)
      : settings(wanted.validated()),
        codec(find_codec(settings.kind)),
        exponent(quantum_exponent_of(settings, *codec)),
        grid(settings.block, exponent, weighs_integral()),
        analyser(std::max(settings.block, kMinTransform), settings.integrated),
        model(first_model()),
        truncation{.model = first_model(), .coded = {}} {}

  StreamSettings settings;
  const AxisCodec* codec;  // never null
  int exponent;
  Grid grid;
  Analyser analyser;
  std::array<Block, kMaxBlocks> ring;
  std::size_t newest = 0;
  int held = 0;    // blocks in the ring, the newest included
  int copies = 0;  // in the last packet
  std::uint16_t sequence = 0;
  ContextModel model;
  Truncation truncation;
  std::size_t newest_bits = 0;
  CodecCounters counters;

  /// Whether the step grows with a coefficient's index.
  bool weighs_integral() const noexcept {
    return settings.integrated && settings.max_rms == 0.0 && codec->transforms;
  }
  ContextModel first_model() const noexcept {
    ContextModel first;
    if (settings.max_rms == 0.0) first.count = std::min(settings.keep, kMaxBlock - 1);
    return first;
  }
  Block& back(int age) noexcept {
    return ring[(newest + kMaxBlocks - static_cast<std::size_t>(age)) % kMaxBlocks];
  }

  AxisContext context() const noexcept {
    AxisContext context;
    context.anchored = settings.anchored;
    context.adaptive = settings.max_rms > 0.0;
    context.model = model;
    return context;
  }
  AxisContext newest_context(const Trend& trend, int axis) const noexcept {
    AxisContext result = context();
    if (settings.anchored) {
      result.trend_level = on_grid(trend.value[axis], grid.level);
      result.trend_slope = on_grid(trend.slope_per_sample[axis], grid.slope);
    }
    return result;
  }
  /// Codes the samples with that model; returns what they cost, bits (PricedCode).
  double code(std::span<const Vec3> samples, const Trend& trend, const ContextModel& habits, bool truncated,
              CodedSamples& coded) const noexcept;
  void bound_by_truncation(std::span<const Vec3> samples, const Trend& trend, double cost_bits,
                           CodedSamples& coded) noexcept;
  void write_block(BitWriter& out, int age, const Trend& trend) noexcept;
  ContextModel learnt_from(const CodedSamples& coded, const ContextModel& before) const noexcept;
};

double BlockEncoder::State::code(std::span<const Vec3> samples, const Trend& trend,
                                 const ContextModel& habits, bool truncated,
                                 CodedSamples& coded) const noexcept {
  std::array<double, kMaxBlock> room;
  const auto values = std::span(room).first(samples.size());
  for (std::size_t n = 0; n < values.size(); ++n) coded.decoded[n].setZero();
  double cost_bits = 0.0;
  for (int a = 0; a < settings.axes; ++a) {
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = samples[n][a];
    AxisContext known = newest_context(trend, a);
    known.model = habits;
    known.truncated = truncated;
    auto& axis = coded.axes[static_cast<std::size_t>(a)];
    axis = codec->encode(values, {settings, grid, analyser}, known);
    cost_bits += axis.cost_bits;
    for (std::size_t n = 0; n < values.size(); ++n) coded.decoded[n][a] = values[n];
  }
  return cost_bits;
}

/// Each block's choice is the cheapest by the habits of its stream, but habits may be bad ones: a choice that
/// was cheapest once makes itself the usual. So the stream is compared with truncation, which has habits of
/// its own, and once it would be the dearer one in all, the block is what truncation makes of it.
void BlockEncoder::State::bound_by_truncation(std::span<const Vec3> samples, const Trend& trend,
                                              double cost_bits, CodedSamples& coded) noexcept {
  const double truncated_bits = code(samples, trend, truncation.model, true, truncation.coded);
  double taken_bits = cost_bits;
  if (truncation.spared_bits + truncated_bits < cost_bits) {
    double rewritten_bits = truncated_bits;  // in this codec's words
    for (int a = 0; a < settings.axes; ++a) {
      const AxisCode& axis = truncation.coded.axes[static_cast<std::size_t>(a)].code;
      AxisContext known = newest_context(trend, a);
      known.model = truncation.model;
      rewritten_bits += newest_axis_bits(axis, known, grid, settings.block);
      known.truncated = true;
      rewritten_bits -= newest_axis_bits(axis, known, grid, settings.block);
    }
    if (rewritten_bits < cost_bits) {
      coded = truncation.coded;
      model = truncation.model;
      taken_bits = rewritten_bits;
    }
  }
  truncation.spared_bits = std::min(truncation.spared_bits + truncated_bits - taken_bits, kMostSpared);
  truncation.model = learnt_from(truncation.coded, truncation.model);
}

void BlockEncoder::State::write_block(BitWriter& out, int age, const Trend& trend) noexcept {
  const auto& block = back(age);
  write_button(out, block.button, settings.block);
  for (int a = 0; a < settings.axes; ++a) {
    const auto at = static_cast<std::size_t>(a);
    auto known = age == 0 ? newest_context(trend, a) : context();
    if (age > 0) {
      known.newest = false;
      known.next = back(age - 1).axes[at].start;
    }
    codec->write(out, block.axes[at], known, grid, settings.block);
  }
}

ContextModel BlockEncoder::State::learnt_from(const CodedSamples& coded,
                                              const ContextModel& before) const noexcept {
  if (!codec->transforms) return before;
  std::array<const AxisCode*, kAxes> codes{};
  const auto axes = static_cast<std::size_t>(settings.axes);
  for (std::size_t a = 0; a < axes; ++a) codes[a] = &coded.axes[a].code;
  return learnt(before, std::span(codes).first(axes), settings.anchored);
}

BlockEncoder::BlockEncoder(const StreamSettings& settings) : state_(std::make_unique<State>(settings)) {}
BlockEncoder::~BlockEncoder() = default;
BlockEncoder::BlockEncoder(BlockEncoder&&) noexcept = default;
BlockEncoder& BlockEncoder::operator=(BlockEncoder&&) noexcept = default;

tl::expected<std::size_t, CodecError> BlockEncoder::encode(std::span<const Vec3> samples,
                                                           std::uint64_t button, const Trend& trend,
                                                           std::span<std::uint8_t> out) noexcept {
  auto& s = *state_;
  const auto refuse = [&](CodecError error) {
    s.counters.count(error);
    s.held = 0;
    return tl::unexpected(error);
  };
  if (samples.size() != static_cast<std::size_t>(s.settings.block)) return refuse(CodecError::kWrongSize);
  if (!is_finite(trend)) return refuse(CodecError::kNotFinite);
  for (const auto& sample : samples) {
    if (!sample.allFinite()) return refuse(CodecError::kNotFinite);
    if (sample.cwiseAbs().maxCoeff() > kMaxMagnitude) return refuse(CodecError::kOutOfRange);
  }
  s.newest = (s.newest + 1) % kMaxBlocks;
  s.held = std::min(s.held + 1, kMaxBlocks);
  auto& block = s.back(0);
  block.button = button;
  const double cost_bits = s.code(samples, trend, s.model, false, block);
  // Truncation has no use for an anchor, and does not keep the integral that counts of an integrated stream.
  if (s.codec->bounded_by_truncation && !s.settings.anchored && !s.settings.integrated)
    s.bound_by_truncation(samples, trend, cost_bits, block);

  BitWriter writer(out);
  PacketHead head;
  head.kind = s.settings.kind;
  head.blocks = 1;
  head.redundancy = s.settings.redundancy;
  head.anchored = s.settings.anchored;
  head.adaptive = s.settings.max_rms > 0.0;
  head.integrated = s.grid.integrated;
  head.block = s.settings.block;
  head.quantum_exponent = s.exponent;
  head.sequence = s.sequence;
  head.axes = s.settings.axes;
  head.model = s.model;
  head.sample_period_ns = s.settings.sample_period_ns;
  write_head(writer, head);
  const auto begin = writer.position();
  s.write_block(writer, 0, trend);
  if (writer.overflowed()) return refuse(CodecError::kNoRoom);
  s.newest_bits = writer.position() - begin;
  int written = 1;
  for (; written < std::min(s.held, s.settings.redundancy + 1); ++written) {
    const auto before = writer.position();
    s.write_block(writer, written, trend);
    if (writer.overflowed()) {
      writer.rewind(before);
      break;
    }
  }
  patch_blocks(out, written);
  s.copies = written - 1;
  s.model = s.learnt_from(block, s.model);
  ++s.sequence;
  ++s.counters.good;
  return writer.bytes();
}

std::span<const Vec3> BlockEncoder::decoded() const noexcept {
  if (state_->held == 0) return {};
  return std::span(state_->back(0).decoded).first(static_cast<std::size_t>(state_->settings.block));
}
std::size_t BlockEncoder::newest_block_bits() const noexcept { return state_->newest_bits; }
const StreamSettings& BlockEncoder::settings() const noexcept { return state_->settings; }
const CodecCounters& BlockEncoder::counters() const noexcept { return state_->counters; }
void BlockEncoder::change(const StreamSettings& settings) {
  State& s = *state_;
  s.settings = settings.validated();
  s.codec = find_codec(s.settings.kind);
  s.exponent = quantum_exponent_of(s.settings, *s.codec);
  s.grid = Grid(s.settings.block, s.exponent, s.weighs_integral());
  s.analyser = Analyser(std::max(s.settings.block, kMinTransform), s.settings.integrated);
  s.model = s.first_model();
  s.truncation = {.model = s.first_model(), .coded = {}};
  s.held = 0;
}
void BlockEncoder::repeat(int copies) noexcept {
  state_->settings.redundancy = std::clamp(copies, 0, kMaxRedundancy);
}
int BlockEncoder::copies() const noexcept { return state_->copies; }
void BlockEncoder::restart() noexcept { state_->held = 0; }

}  // namespace telekerf::codec
