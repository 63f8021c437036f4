// SPDX-License-Identifier: Apache-2.0
#include "common/codec/encoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "common/codec/analysis.h"
#include "common/codec/baselines/time_domain_codecs.h"

namespace telekerf::codec {
namespace {

bool is_transform(CodecKind kind) { return kind == CodecKind::kSdct || kind == CodecKind::kTruncatedDct; }

/// Adaptive streams derive their finest step from the promise: a transform's rounding is at most half a step
/// in each coefficient, so 2 epsilon always keeps it; a lattice tries up to four half octaves above its
/// finest, sqrt(12) epsilon.
int quantum_exponent_of(const StreamSettings& settings) {
  double finest = settings.quantum;
  if (settings.max_rms > 0.0)
    finest = (is_transform(settings.kind) ? 2.0 : 0.5 * std::sqrt(3.0)) * settings.max_rms;
  return std::clamp(static_cast<int>(std::floor(4.0 * std::log2(finest))), -kMaxQuantumExponent,
                    kMaxQuantumExponent);
}

struct Axis {
  AxisCode code;
  ShapeEnds ends;
  Successor start;
};

/// A block that is kept for the packets to come.
struct Block {
  std::array<Axis, kAxes> axes;
  std::uint64_t button = 0;
  std::array<Vec3, kMaxBlock> decoded;
};

}  // namespace

struct BlockEncoder::State {
  explicit State(const StreamSettings& wanted)
      : settings(wanted.validated()),
        exponent(quantum_exponent_of(settings)),
        grid(settings.block, exponent),
        analyser(std::max(settings.block, kMinTransform), settings.integrated),
        habits(first_habits()) {}

  StreamSettings settings;
  int exponent;
  Grid grid;
  Analyser analyser;
  std::array<Block, kMaxBlocks> ring;
  std::size_t newest = 0;
  int held = 0;  // blocks in the ring, the newest included
  std::uint16_t sequence = 0;
  ContextModel habits;
  std::size_t newest_bits = 0;
  CodecCounters counters;

  ContextModel first_habits() const noexcept {
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
    context.truncated = settings.kind == CodecKind::kTruncatedDct;
    context.habits = habits;
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
  void analyse(std::span<const Vec3> samples, const Trend& trend, Block& block) const noexcept;
  void write_block(BitWriter& out, int age, const Trend& trend) noexcept;
  void learn_habits(const Block& block) noexcept;
};

void BlockEncoder::State::analyse(std::span<const Vec3> samples, const Trend& trend,
                                  Block& block) const noexcept {
  std::array<double, kMaxBlock> values;
  std::array<double, kMaxBlock> shape_room;
  const auto count = samples.size();
  for (std::size_t n = 0; n < count; ++n) block.decoded[n].setZero();
  for (int a = 0; a < settings.axes; ++a) {
    auto& axis = block.axes[static_cast<std::size_t>(a)];
    for (std::size_t n = 0; n < count; ++n) values[n] = samples[n][a];
    const auto part = std::span(values).first(count);
    if (settings.kind == CodecKind::kRaw) {
      for (std::size_t n = 0; n < count; ++n) {
        axis.code.raw[n] = static_cast<float>(values[n]);
        block.decoded[n][a] = static_cast<double>(axis.code.raw[n]);
      }
      continue;
    }
    if (!is_transform(settings.kind)) {
      axis.code = analyse_lattice(part, settings, grid);
      reconstruct_lattice(axis.code, grid, part);
      for (std::size_t n = 0; n < count; ++n) block.decoded[n][a] = values[n];
      continue;
    }
    axis.code = analyser.analyse(part, {settings.keep, settings.max_rms}, newest_context(trend, a), grid);
    const auto shape = std::span(shape_room).first(count);
    shape_of(axis.code, grid, Dct::of_size(settings.block), shape);
    axis.ends = ends_of(shape);
    reconstruct(axis.code, grid, shape, part);
    axis.start = successor_of(axis.code, grid, part);
    for (std::size_t n = 0; n < count; ++n) block.decoded[n][a] = values[n];
  }
}

void BlockEncoder::State::write_block(BitWriter& out, int age, const Trend& trend) noexcept {
  const auto& block = back(age);
  write_button(out, block.button, settings.block);
  for (int a = 0; a < settings.axes; ++a) {
    const auto at = static_cast<std::size_t>(a);
    if (settings.kind == CodecKind::kRaw) {
      for (int n = 0; n < settings.block; ++n) {
        out.bits(std::bit_cast<std::uint32_t>(block.axes[at].code.raw[static_cast<std::size_t>(n)]), 32);
      }
      continue;
    }
    if (!is_transform(settings.kind)) {
      write_lattice(out, {settings.kind, settings.max_rms > 0.0}, block.axes[at].code, settings.block);
      continue;
    }
    auto known = age == 0 ? newest_context(trend, a) : context();
    if (age > 0) {
      known.newest = false;
      known.next = back(age - 1).axes[at].start;
    }
    write_axis(out, block.axes[at].code, block.axes[at].ends, known, grid, settings.block);
  }
}

void BlockEncoder::State::learn_habits(const Block& block) noexcept {
  if (!is_transform(settings.kind)) return;
  int count = 0;
  int offset = 0;
  int level_order = 0;
  int value_order = 0;
  int used = 0;
  for (int a = 0; a < settings.axes; ++a) {
    const auto& code = block.axes[static_cast<std::size_t>(a)].code;
    const auto width = [&](std::size_t k) {
      return static_cast<int>(std::bit_width(zigzag(code.values[k])));
    };
    if (code.mode == Mode::kRunLength) level_order = std::max(level_order, width(0) - 2);
    if (!code.is_transformed()) continue;
    count += std::popcount(code.set);
    offset += code.step_offset;
    ++used;
    level_order = std::max(level_order, width(0) - 2);
    const auto upper = code.set & ~IndexSet{settings.anchored && code.has_level() ? 0u : 1u};
    if (upper != 0) value_order += width(static_cast<std::size_t>(std::countr_zero(upper))) - 1;
  }
  habits.level_order = std::clamp(level_order, 0, 31);
  if (used == 0) return;
  habits.count = std::min((count + used / 2) / used, 63);
  habits.step_offset = std::clamp((offset + used / 2) / used, 0, 31);
  habits.value_order = std::clamp(value_order / used, 0, 15);
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
  s.held = std::min(s.held + 1, s.settings.redundancy + 1);
  auto& block = s.back(0);
  block.button = button;
  s.analyse(samples, trend, block);

  BitWriter writer(out);
  PacketHead head;
  head.kind = s.settings.kind;
  head.blocks = 1;
  head.redundancy = s.settings.redundancy;
  head.anchored = s.settings.anchored;
  head.adaptive = s.settings.max_rms > 0.0;
  head.block = s.settings.block;
  head.quantum_exponent = s.exponent;
  head.sequence = s.sequence;
  head.axes = s.settings.axes;
  head.habits = s.habits;
  head.sample_period_ns = s.settings.sample_period_ns;
  write_head(writer, head);
  const auto begin = writer.position();
  s.write_block(writer, 0, trend);
  if (writer.overflowed()) return refuse(CodecError::kNoRoom);
  s.newest_bits = writer.position() - begin;
  int written = 1;
  for (; written < s.held; ++written) {
    const auto before = writer.position();
    s.write_block(writer, written, trend);
    if (writer.overflowed()) {
      writer.rewind(before);
      break;
    }
  }
  patch_blocks(out, written);
  s.learn_habits(block);
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
  s.exponent = quantum_exponent_of(s.settings);
  s.grid = Grid(s.settings.block, s.exponent);
  s.analyser = Analyser(std::max(s.settings.block, kMinTransform), s.settings.integrated);
  s.habits = s.first_habits();
  s.held = 0;
}
void BlockEncoder::restart() noexcept { state_->held = 0; }

}  // namespace telekerf::codec
