// SPDX-License-Identifier: Apache-2.0
#include "common/codec/axis_bits.h"

#include <algorithm>
#include <bit>

#include "common/codec/raw_samples.h"
#include "common/codec/run_length.h"

namespace telekerf::codec {
namespace {

// Orders of the Exp-Golomb codes, measured on the traces of docs/results/codec.md.
constexpr int kKeptOrder = 0;
constexpr int kBendOrder = 4;
constexpr int kSlopeOrder = 3;
constexpr int kCorrectionOrder = 2;

// Modes by frequency: with a trend the curve is the usual one, without it nothing is.
using Modes = std::array<Mode, 6>;
constexpr Modes kAnchoredModes{Mode::kCurve, Mode::kLine,      Mode::kHold,
                               Mode::kIntra, Mode::kRunLength, Mode::kRaw};
constexpr Modes kFreeModes{Mode::kIntra,     Mode::kCurve, Mode::kLine,
                           Mode::kRunLength, Mode::kRaw,   Mode::kHold};
constexpr Modes kTruncatedModes{Mode::kIntra, Mode::kRaw, Mode::kRaw, Mode::kRaw, Mode::kRaw, Mode::kRaw};

const Modes& modes(const AxisContext& context) {
  return context.truncated ? kTruncatedModes : (context.anchored ? kAnchoredModes : kFreeModes);
}
constexpr int kLastMode = 5;

/// The order for a value after one of magnitude |previous|: coefficients fall off slowly.
int next_order(std::int64_t previous) noexcept {
  const auto magnitude = static_cast<std::uint64_t>(previous < 0 ? -previous : previous);
  return std::clamp(static_cast<int>(std::bit_width(magnitude)) - 1, 0, 40);
}

/// Without a level parameter coefficient 0 is the level: told whole, or by difference from the successor's
/// guess.
bool carries_level(const AxisCode& code, const AxisContext& context) noexcept {
  return !(context.anchored && code.has_level());
}

/// How the index set is told: by name (enumerative), or as the prefix 0..count-1, where values may be zero.
struct Telling {
  bool prefix = true;
  int count = 0;
  IndexSet told = 0;
};

template <typename Sink>
void write_values(Sink& out, const AxisCode& code, const AxisContext& context,
                  const Telling& telling) noexcept {
  int order = context.model.value_order;
  for (auto set = telling.told; set != 0; set &= set - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(set));
    const bool level = k == 0 && carries_level(code, context);
    if (level && !context.newest) continue;  // told last
    const std::uint64_t symbol =
        zigzag(code.values[k]) - (telling.prefix ? 0 : 1);  // a named one is never zero
    out.golomb(symbol, level ? context.model.level_order : order);
    if (!level) order = next_order(code.values[k]);
  }
}

Telling cheapest_telling(const AxisCode& code, const AxisContext& context, int block) noexcept {
  const auto length = static_cast<int>(std::bit_width(code.set));
  const Telling prefix{true, length, first_indices(length)};
  if (context.truncated) return prefix;
  const Telling named{false, std::popcount(code.set), code.set};
  BitCounter named_bits;
  named_bits.signed_golomb(named.count - context.model.count, kKeptOrder);
  named_bits.bits(0, index_set_bits(block, named.count));
  write_values(named_bits, code, context, named);
  BitCounter prefix_bits;
  prefix_bits.signed_golomb(prefix.count - context.model.count, kKeptOrder);
  write_values(prefix_bits, code, context, prefix);
  return prefix_bits.count() <= named_bits.count() ? prefix : named;
}

std::int64_t level_guess(const AxisCode& code, const ShapeEnds& ends, const AxisContext& context,
                         const Grid& grid, int block) noexcept {
  const double base = base_before(context.next, ends, code, grid, block);
  if (carries_level(code, context)) return on_grid(base * std::sqrt(block), grid.step(code.step_offset));
  const double coefficient = (code.set & 1) != 0 ? static_cast<double>(code.values[0]) : 0.0;
  return on_grid(base - coefficient * grid.step(code.step_offset) / std::sqrt(block), grid.level);
}

std::int64_t slope_guess(const ShapeEnds& ends, const AxisContext& context, const Grid& grid,
                         int block) noexcept {
  if (!context.anchored) return 0;
  return context.newest ? context.trend_slope : slope_before(context.next, ends, grid, block);
}

int slope_order(const AxisContext& context) noexcept {
  return context.anchored ? (context.newest ? 0 : kCorrectionOrder) : kSlopeOrder;
}

/// Where a block of held values begins: at its trend, or so that it ends where its successor begins.
std::int64_t run_guess(const AxisCode& code, const AxisContext& context, const Grid& grid,
                       int block) noexcept {
  const double step = grid.step(code.step_offset);
  if (context.newest) return on_grid(grid.level * static_cast<double>(context.trend_level), step);
  const auto rise = code.values[static_cast<std::size_t>(block - 1)] - code.values[0];
  return on_grid(context.next.first, step) - rise;
}
int run_order(const AxisContext& context) noexcept {
  return context.newest && !context.anchored ? context.model.level_order : kCorrectionOrder;
}

bool read_run_lengths(BitReader& in, AxisCode& code, const AxisContext& context, const Grid& grid,
                      int block) noexcept {
  if (!read_runs(in, code, block)) return false;
  const auto first = run_guess(code, context, grid, block) + in.signed_golomb(run_order(context));
  for (auto& value : std::span(code.values).first(static_cast<std::size_t>(block))) {
    value += first;
    if (std::abs(value) > kMaxParameter) return false;
  }
  return !in.failed();
}

/// The first of the modes tells with its own bits whether it is a prefix: that is the usual, and one bit.
template <typename Sink>
void write_mode(Sink& out, Mode mode, bool prefix, const AxisContext& context) noexcept {
  const auto& order = modes(context);
  const auto at = static_cast<int>(std::find(order.begin(), order.end(), mode) - order.begin());
  if (context.truncated || (at == 0 && prefix)) {
    out.bits(at == 0 ? 0 : 1, 1);
    return;
  }
  out.bits(1, 1);
  for (int i = 0; i < at; ++i) out.bits(1, 1);
  if (at < kLastMode) out.bits(0, 1);
  if (at > 0 && mode != Mode::kRunLength && mode != Mode::kRaw) out.bits(prefix ? 0 : 1, 1);
}

Mode read_mode(BitReader& in, bool& prefix, const AxisContext& context) noexcept {
  const auto& order = modes(context);
  prefix = true;
  if (!in.bit()) return order[0];
  if (context.truncated) return order[1];
  int at = 0;
  while (at < kLastMode && in.bit()) ++at;
  const Mode mode = order[static_cast<std::size_t>(at)];
  if (at == 0) {
    prefix = false;
  } else if (mode != Mode::kRunLength && mode != Mode::kRaw) {
    prefix = !in.bit();
  }
  return mode;
}

template <typename Sink>
void write_any(Sink& out, const AxisCode& code, const ShapeEnds& ends, const AxisContext& context,
               const Grid& grid, int block) noexcept {
  const Telling telling = code.is_transformed() ? cheapest_telling(code, context, block) : Telling{};
  write_mode(out, code.mode, telling.prefix, context);
  if (code.mode == Mode::kRaw) return write_raw_samples(out, code, block);
  if (context.adaptive) out.signed_golomb(code.step_offset - context.model.step_offset, 0);
  if (code.mode == Mode::kRunLength) {
    write_runs(out, code);
    out.signed_golomb(code.values[0] - run_guess(code, context, grid, block), run_order(context));
    return;
  }
  out.signed_golomb(telling.count - context.model.count, kKeptOrder);
  if (!telling.prefix) out.bits(rank_of(code.set), index_set_bits(block, telling.count));
  write_values(out, code, context, telling);
  if (code.has_bend()) out.signed_golomb(code.bend, kBendOrder);
  if (code.has_slope()) {
    out.signed_golomb(code.slope - slope_guess(ends, context, grid, block), slope_order(context));
  }
  if (context.newest) return;  // its level is the trend's, or coefficient 0
  if (!carries_level(code, context)) {
    out.signed_golomb(code.level - level_guess(code, ends, context, grid, block), kCorrectionOrder);
  } else if ((telling.told & 1) != 0) {
    out.signed_golomb(code.values[0] - level_guess(code, ends, context, grid, block), kCorrectionOrder);
  }
}

/// Reads the values of the told coefficients, coefficient 0 only where write_values() writes it.
bool read_values(BitReader& in, AxisCode& code, const AxisContext& context, const Telling& telling) noexcept {
  int order = context.model.value_order;
  code.set = 0;
  for (auto set = telling.told; set != 0; set &= set - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(set));
    const bool level = k == 0 && carries_level(code, context);
    if (level && !context.newest) continue;
    code.values[k] =
        unzigzag(in.golomb(level ? context.model.level_order : order) + (telling.prefix ? 0 : 1));
    if (in.failed() || std::abs(code.values[k]) > kMaxValue) return false;
    if (!level) order = next_order(code.values[k]);
    if (code.values[k] != 0) code.set |= IndexSet{1} << k;
  }
  return true;
}

bool read_telling(BitReader& in, Telling& telling, const AxisContext& context, int block) noexcept {
  const auto count = in.signed_golomb(kKeptOrder) + context.model.count;
  if (in.failed() || count < 0 || count > block) return false;
  telling.count = static_cast<int>(count);
  telling.told = first_indices(telling.count);
  if (telling.prefix) return true;
  const auto rank = in.bits(index_set_bits(block, telling.count));
  if (in.failed() || rank >= choose(block, telling.count)) return false;
  telling.told = set_of_rank(rank, block, telling.count);
  return true;
}

}  // namespace

void write_axis(BitWriter& out, const AxisCode& code, const ShapeEnds& ends, const AxisContext& context,
                const Grid& grid, int block) noexcept {
  write_any(out, code, ends, context, grid, block);
}

int newest_axis_bits(const AxisCode& code, const AxisContext& context, const Grid& grid, int block) noexcept {
  BitCounter counter;
  write_any(counter, code, {}, context, grid, block);
  return counter.count();
}

bool read_axis(BitReader& in, AxisCode& code, const AxisContext& context, const Grid& grid, const Dct& dct,
               std::span<double> samples) noexcept {
  const int block = dct.size();
  Telling telling;
  code.mode = read_mode(in, telling.prefix, context);
  if (code.mode == Mode::kRaw) return read_raw_samples(in, samples);
  if (code.mode == Mode::kHold && !context.anchored) return false;

  const auto offset = context.adaptive ? context.model.step_offset + in.signed_golomb(0) : 0;
  if (in.failed() || offset < 0 || offset > kMaxStepOffset) return false;
  code.step_offset = static_cast<int>(offset);
  if (code.mode == Mode::kRunLength) {
    if (!read_run_lengths(in, code, context, grid, block)) return false;
    reconstruct(code, grid, {}, samples);
    return true;
  }
  if (!read_telling(in, telling, context, block) || !read_values(in, code, context, telling)) return false;
  if (code.has_bend()) code.bend = in.signed_golomb(kBendOrder);
  if (in.failed() || std::abs(code.bend) > kMaxParameter) return false;

  std::array<double, kMaxBlock> shape_room;
  const auto shape = std::span(shape_room).first(samples.size());
  shape_of(code, grid, dct, shape);
  const auto ends = ends_of(shape);
  if (code.has_slope())
    code.slope = slope_guess(ends, context, grid, block) + in.signed_golomb(slope_order(context));
  if (std::abs(code.slope) > 2 * kMaxParameter) return false;
  code.level = context.trend_level;
  if (!context.newest) {
    if (!carries_level(code, context)) {
      code.level = level_guess(code, ends, context, grid, block) + in.signed_golomb(kCorrectionOrder);
    } else if ((telling.told & 1) != 0) {
      code.values[0] = level_guess(code, ends, context, grid, block) + in.signed_golomb(kCorrectionOrder);
      if (code.values[0] != 0) code.set |= 1;
    }
  }
  if (in.failed() || std::abs(code.level) > 2 * kMaxParameter || std::abs(code.values[0]) > kMaxValue)
    return false;
  reconstruct(code, grid, shape, samples);
  for (const double sample : samples) {
    if (!(std::abs(sample) <= 2.0 * kMaxMagnitude)) return false;
  }
  return true;
}

}  // namespace telekerf::codec
