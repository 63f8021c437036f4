// SPDX-License-Identifier: Apache-2.0
#include "common/codec/analysis.h"

#include <algorithm>
#include <bit>

namespace telekerf::codec {
namespace {

/// A value is worth sending from 0.6 of a step up: below, its bits buy less than they do elsewhere.
constexpr double kDeadZone = 0.6;
/// Squared quanta of error that one bit is worth (the slope of D = step^2 / 12 over the rate, about).
constexpr double kEnergyPerBit = 0.12;
/// Steps tried above the finest in adaptive mode.
constexpr int kStepsTried = 3;
constexpr int kMaxFits = 5;

double squared(double x) { return x * x; }

/// The smallest offset at which the largest value stays an integer that can be sent.
int first_offset(std::span<const double> residual, const Grid& grid) noexcept {
  double largest = 0.0;
  for (const double c : residual) largest = std::max(largest, std::abs(c));
  int offset = 0;
  while (largest >= 0.5 * static_cast<double>(kMaxValue) * grid.step(offset) && offset < kMaxStepOffset)
    ++offset;
  return offset;
}

}  // namespace

Analyser::Analyser(int block) : block_(block), dct_(&Dct::of_size(block)) {
  std::array<double, kMaxBlock> n1{};
  std::array<double, kMaxBlock> n2{};
  for (int n = 0; n < block; ++n) {
    n1[static_cast<std::size_t>(n)] = n;
    n2[static_cast<std::size_t>(n)] = 0.5 * n * n;
  }
  dct_->forward(n1, ramp_);
  dct_->forward(n2, parabola_);
}

int Analyser::fits(std::span<const double> coefficients, int from, const AxisContext& context,
                   const Grid& grid, std::span<Fit> found) const noexcept {
  // Least squares on the coefficients from `from` up: the lower ones are sent anyway and cost nothing more,
  // the higher ones are what a polynomial can spare.
  double rr = 0, rp = 0, pp = 0, rc = 0, pc = 0;
  for (auto k = static_cast<std::size_t>(from); k < coefficients.size(); ++k) {
    rr += ramp_[k] * ramp_[k];
    rp += ramp_[k] * parabola_[k];
    pp += parabola_[k] * parabola_[k];
    rc += ramp_[k] * coefficients[k];
    pc += parabola_[k] * coefficients[k];
  }
  int count = 0;
  const auto add = [&](Mode mode, std::int64_t slope, std::int64_t bend) {
    found[static_cast<std::size_t>(count++)] = {mode, slope, bend};
  };
  add(Mode::kIntra, 0, 0);
  if (context.anchored) add(Mode::kHold, 0, 0);
  const double determinant = rr * pp - rp * rp;
  const auto slope_alone = on_grid(rc / rr, grid.slope);
  if (context.anchored) {
    const auto slope = context.trend_slope;
    add(Mode::kLine, slope, 0);
    add(Mode::kCurve, slope, on_grid((pc - rp * static_cast<double>(slope) * grid.slope) / pp, grid.bend));
  } else if (slope_alone != 0) {
    add(Mode::kLine, slope_alone, 0);
  }
  if (determinant > 1e-9 * rr * pp) {
    const auto slope = on_grid((rc * pp - pc * rp) / determinant, grid.slope);
    const auto bend = on_grid((pc * rr - rc * rp) / determinant, grid.bend);
    if (bend != 0 && !(context.anchored && slope == context.trend_slope)) add(Mode::kCurve, slope, bend);
  }
  return count;
}

Analyser::Candidate Analyser::fixed(std::span<const double> residual, AxisCode code, int keep,
                                    const AxisContext& context, const Grid& grid) const noexcept {
  Candidate candidate;
  code.step_offset = first_offset(residual, grid);
  const double step = grid.step(code.step_offset);
  const IndexSet kept = strongest(residual, keep);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const double c = residual[k];
    if ((kept >> k & 1) != 0 && std::abs(c) >= kDeadZone * step) {
      const auto value = static_cast<std::int64_t>(std::llround(c / step));
      code.values[k] = value;
      code.set |= IndexSet{1} << k;
      candidate.energy += squared(c - static_cast<double>(value) * step);
    } else {
      candidate.energy += squared(c);
    }
  }
  candidate.bits = newest_axis_bits(code, context, grid, block_);
  candidate.code = code;
  candidate.feasible = true;
  return candidate;
}

Analyser::Candidate Analyser::adaptive(std::span<const double> residual, AxisCode code, int offset,
                                       double max_rms, const AxisContext& context,
                                       const Grid& grid) const noexcept {
  Candidate candidate;
  code.step_offset = std::min(first_offset(residual, grid) + offset, kMaxStepOffset);
  const double step = grid.step(code.step_offset);
  // A hair below the promise, so that rounding in the sums cannot break it.
  const double allowed = squared(max_rms) * block_ * (1.0 - 1e-9);
  std::array<double, kMaxBlock> saving{};  // error energy that sending k spares
  std::array<std::uint8_t, kMaxBlock> order{};
  int count = 0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const auto value = static_cast<std::int64_t>(std::llround(residual[k] / step));
    const double error = squared(residual[k] - static_cast<double>(value) * step);
    candidate.energy += error;
    if (value == 0) continue;
    code.values[k] = value;
    code.set |= IndexSet{1} << k;
    saving[k] = squared(residual[k]) - error;
    order[static_cast<std::size_t>(count++)] = static_cast<std::uint8_t>(k);
  }
  if (candidate.energy > allowed) return candidate;
  // The least m: give up the weakest as long as the promise holds; of equals the higher index goes first.
  std::sort(order.begin(), order.begin() + count, [&](std::uint8_t a, std::uint8_t b) {
    return saving[a] != saving[b] ? saving[a] < saving[b] : a > b;
  });
  for (int i = 0; i < count; ++i) {
    const std::size_t k = order[static_cast<std::size_t>(i)];
    if (candidate.energy + saving[k] > allowed) break;
    candidate.energy += saving[k];
    code.values[k] = 0;
    code.set &= ~(IndexSet{1} << k);
  }
  candidate.bits = newest_axis_bits(code, context, grid, block_);
  candidate.code = code;
  candidate.feasible = true;
  return candidate;
}

AxisCode Analyser::analyse(std::span<const double> samples, const Aim& aim, const AxisContext& context,
                           const Grid& grid) const noexcept {
  std::array<double, kMaxBlock> shifted;
  std::array<double, kMaxBlock> coefficients;
  const auto size = samples.size();
  // Numerically the trend's level goes first; an intra block gets it back in coefficient 0.
  const double level = context.anchored ? grid.level * static_cast<double>(context.trend_level) : 0.0;
  for (std::size_t n = 0; n < size; ++n) shifted[n] = samples[n] - level;
  dct_->forward(std::span(shifted).first(size), coefficients);
  const double level_coefficient = level * std::sqrt(block_);

  std::array<Fit, kMaxFits> found;
  const int from = aim.max_rms > 0.0 ? 2 : std::min(aim.keep / 2 + 1, block_ - 2);
  const int count = fits(std::span(coefficients).first(size), from, context, grid, found);
  Candidate best;
  std::array<double, kMaxBlock> residual;
  const auto take = [&](const Candidate& candidate) {
    if (!candidate.feasible) return;
    const auto cost = [&](const Candidate& c) {
      return aim.max_rms > 0.0 ? c.bits : c.energy / squared(grid.level) + kEnergyPerBit * c.bits;
    };
    if (!best.feasible || cost(candidate) < cost(best)) best = candidate;
  };
  for (int i = 0; i < count; ++i) {
    const auto& fit = found[static_cast<std::size_t>(i)];
    AxisCode code;
    code.mode = fit.mode;
    code.level = context.trend_level;
    code.slope = fit.slope;
    code.bend = fit.bend;
    const double slope = code.has_slope() ? grid.slope * static_cast<double>(fit.slope) : 0.0;
    const double bend = code.has_bend() ? grid.bend * static_cast<double>(fit.bend) : 0.0;
    for (std::size_t k = 0; k < size; ++k)
      residual[k] = coefficients[k] - slope * ramp_[k] - bend * parabola_[k];
    if (!code.has_level()) residual[0] += level_coefficient;
    const auto part = std::span<const double>(residual).first(size);
    if (aim.max_rms > 0.0) {
      for (int offset = 0; offset < kStepsTried; ++offset)
        take(adaptive(part, code, offset, aim.max_rms, context, grid));
    } else {
      take(fixed(part, code, aim.keep, context, grid));
    }
  }
  constexpr int kFloatBits = 32;
  if (best.feasible && best.bits <= kFloatBits * block_) return best.code;
  AxisCode raw;
  raw.mode = Mode::kRaw;
  for (std::size_t n = 0; n < size; ++n) raw.raw[n] = static_cast<float>(samples[n]);
  return raw;
}

}  // namespace telekerf::codec
