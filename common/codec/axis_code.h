// SPDX-License-Identifier: Apache-2.0
// One axis of one block as integers: what is sent, and the only thing decoded samples are made from.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "common/codec/dct.h"
#include "common/codec/selection.h"

namespace telekerf::codec {

/// What the transform's residual stands on. The polynomial is given by integers that travel with the block,
/// so a redundant copy decodes to the same bits whatever packet it rides in.
enum class Mode : std::uint8_t {
  kIntra,      ///< nothing
  kHold,       ///< level
  kLine,       ///< level + slope n
  kCurve,      ///< level + slope n + bend n^2 / 2
  kRunLength,  ///< no transform: values held from sample to sample, told by run length (jumps, held signals)
  kRaw,        ///< float32 samples, when that is smaller or nothing else keeps the promised error
};

/// Steps of the integers. Slope and bend are as coarse as four quanta at the block's end: what they miss is
/// smooth, and the low coefficients, which are sent anyway, take it up.
struct Grid {
  /// `integrated`: see step_of().
  Grid(int block, int quantum_exponent, bool integrated = false) noexcept;

  double level;
  double slope = 0.0;
  double bend = 0.0;
  bool integrated;

  /// Step of the coefficients of an axis, `offset` half octaves above the stream's finest.
  double step(int offset) const noexcept { return fractional_power(level, 2 * offset); }
  /// Of coefficient k. Twice integrated, the cosine of index k comes to less and less: at a step of 7/4 k^2
  /// its rounding moves the integral about as far as the mean's does at a step of 1.
  double step_of(std::size_t k, int offset) const noexcept {
    const auto index = static_cast<double>(k);
    return integrated && k > 0 ? 1.75 * index * index * step(offset) : step(offset);
  }
  /// base 2^(quarters/4), the same bits everywhere: no library's power function is asked.
  static double fractional_power(double base, int quarters) noexcept;
};
/// The finest step of a stream is 2^(exponent/4), exponent within +-this.
inline constexpr int kMaxQuantumExponent = 255;

inline constexpr std::int64_t kMaxParameter = std::int64_t{1} << 45;
inline constexpr std::int64_t kMaxValue = std::int64_t{1} << 40;
inline constexpr int kMaxStepOffset = 254;
inline constexpr double kMaxMagnitude = 1e30;

/// value / grid rounded and clamped to +-kMaxParameter; both ends get the same integer. `value` must be
/// finite.
std::int64_t on_grid(double value, double grid) noexcept;

/// The smallest step, in half octaves above the finest, at which the largest of `values` stays an integer
/// that can be sent.
int min_step_offset(std::span<const double> values, const Grid& grid) noexcept;

struct AxisCode {
  Mode mode = Mode::kIntra;
  std::int64_t level = 0;
  std::int64_t slope = 0;
  std::int64_t bend = 0;
  int step_offset = 0;
  IndexSet set = 0;  ///< coefficients with a non-zero value; run length: samples at which the value changes
  std::array<std::int64_t, kMaxBlock> values{};
  std::array<float, kMaxBlock> raw{};

  bool has_level() const noexcept { return mode == Mode::kHold || has_slope(); }
  bool has_slope() const noexcept { return mode == Mode::kLine || mode == Mode::kCurve; }
  bool has_bend() const noexcept { return mode == Mode::kCurve; }
  bool is_transformed() const noexcept { return mode != Mode::kRunLength && mode != Mode::kRaw; }
};

/// The block without its level, slope and coefficient 0: bend and coefficients from 1 up.
void shape_of(const AxisCode& code, const Grid& grid, const Dct& dct, std::span<double> shape) noexcept;
/// Constant part: level and coefficient 0.
double base_of(const AxisCode& code, const Grid& grid, int block) noexcept;
/// The decoded samples.
void reconstruct(const AxisCode& code, const Grid& grid, std::span<const double> shape,
                 std::span<double> samples) noexcept;

/// What a shape tells about its neighbour in time.
struct ShapeEnds {
  double first = 0.0;
  double second = 0.0;
  double before_last = 0.0;
  double last = 0.0;
};
ShapeEnds ends_of(std::span<const double> shape) noexcept;

/// The start of the block that follows, decoded from the same packet.
struct Successor {
  double first = 0.0;  ///< its sample 0
  std::int64_t slope = 0;
};
Successor successor_of(const AxisCode& code, const Grid& grid, std::span<const double> samples) noexcept;

/// Backwards in time: slope, level and coefficient 0 of a block, guessed from its shape and its successor's
/// start.
std::int64_t slope_before(const Successor& next, const ShapeEnds& ends, const Grid& grid, int block) noexcept;
double base_before(const Successor& next, const ShapeEnds& ends, const AxisCode& code, const Grid& grid,
                   int block) noexcept;

}  // namespace telekerf::codec
