// SPDX-License-Identifier: Apache-2.0
#include "common/codec/axis_code.h"

#include <algorithm>
#include <bit>

namespace telekerf::codec {
namespace {

/// 2^exponent within +-1000: ldexp() without the call.
double power_of_two(int exponent) {
  constexpr int kBias = 1023;
  constexpr int kFractionBits = 52;
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << kFractionBits);
}

}  // namespace

Grid::Grid(int block, int quantum_exponent, bool wanted_integrated) noexcept
    : level(fractional_power(1.0, quantum_exponent)), integrated(wanted_integrated) {
  int log_block = 0;
  while ((1 << log_block) < block) ++log_block;
  slope = level * power_of_two(2 - log_block);
  bend = level * power_of_two(3 - 2 * log_block);
}

double Grid::fractional_power(double base, int quarters) noexcept {
  constexpr std::array<double, 4> kQuarterOctaves{1.0, 1.189207115002721, 1.4142135623730951,
                                                  1.681792830507429};
  const int octaves = quarters >= 0 ? quarters / 4 : (quarters - 3) / 4;
  return base * kQuarterOctaves[static_cast<std::size_t>(quarters - 4 * octaves)] * power_of_two(octaves);
}

std::int64_t on_grid(double value, double grid) noexcept {
  constexpr auto kLimit = static_cast<double>(kMaxParameter);
  return static_cast<std::int64_t>(std::clamp(std::nearbyint(value / grid), -kLimit, kLimit));
}

int min_step_offset(std::span<const double> values, const Grid& grid) noexcept {
  double largest = 0.0;
  for (const double x : values) largest = std::max(largest, std::abs(x));
  int offset = 0;
  while (largest >= 0.5 * static_cast<double>(kMaxValue) * grid.step(offset) && offset < kMaxStepOffset)
    ++offset;
  return offset;
}

void shape_of(const AxisCode& code, const Grid& grid, const Dct& dct, std::span<double> shape) noexcept {
  if (!code.is_transformed()) {
    std::fill(shape.begin(), shape.end(), 0.0);
    return;
  }
  std::array<double, kMaxBlock> coefficients{};
  for (auto set = code.set & ~IndexSet{1}; set != 0; set &= set - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(set));
    coefficients[k] = static_cast<double>(code.values[k]) * grid.step_of(k, code.step_offset);
  }
  dct.inverse(coefficients, shape);
  if (!code.has_bend()) return;
  const double half_bend = 0.5 * grid.bend * static_cast<double>(code.bend);
  for (std::size_t n = 0; n < shape.size(); ++n) shape[n] += half_bend * static_cast<double>(n * n);
}

double base_of(const AxisCode& code, const Grid& grid, int block) noexcept {
  const double level = code.has_level() ? grid.level * static_cast<double>(code.level) : 0.0;
  if ((code.set & 1) == 0) return level;
  return level + static_cast<double>(code.values[0]) * grid.step(code.step_offset) / std::sqrt(block);
}

void reconstruct(const AxisCode& code, const Grid& grid, std::span<const double> shape,
                 std::span<double> samples) noexcept {
  if (code.mode == Mode::kRaw) {
    std::copy_n(code.raw.begin(), samples.size(), samples.begin());
    return;
  }
  if (code.mode == Mode::kRunLength) {
    const double step = grid.step(code.step_offset);
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = step * static_cast<double>(code.values[n]);
    return;
  }
  const double base = base_of(code, grid, static_cast<int>(samples.size()));
  const double slope = code.has_slope() ? grid.slope * static_cast<double>(code.slope) : 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n] = base + slope * static_cast<double>(n) + shape[n];
  }
}

ShapeEnds ends_of(std::span<const double> shape) noexcept {
  const auto size = shape.size();
  return {shape[0], shape[1], shape[size - 2], shape[size - 1]};
}

Successor successor_of(const AxisCode& code, const Grid& grid, std::span<const double> samples) noexcept {
  return {samples[0], code.has_slope() ? code.slope : on_grid(samples[1] - samples[0], grid.slope)};
}

std::int64_t slope_before(const Successor& next, const ShapeEnds& ends, const Grid& grid,
                          int block) noexcept {
  // The shape's own change of slope, from the differences at its ends, N - 2 samples apart.
  const double change = ((ends.last - ends.before_last) - (ends.second - ends.first)) * block / (block - 2);
  return std::clamp(next.slope - on_grid(change, grid.slope), -kMaxParameter, kMaxParameter);
}

double base_before(const Successor& next, const ShapeEnds& ends, const AxisCode& code, const Grid& grid,
                   int block) noexcept {
  const double slope = code.has_slope() ? grid.slope * static_cast<double>(code.slope) : 0.0;
  return next.first - slope * block - (2.0 * ends.last - ends.before_last);
}

}  // namespace telekerf::codec
