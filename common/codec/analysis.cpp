// SPDX-License-Identifier: Apache-2.0
#include "common/codec/analysis.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "common/codec/raw_samples.h"
#include "common/codec/run_length.h"

namespace telekerf::codec {
namespace {

/// A value is worth sending from 0.6 of a step up: below, its bits buy less than they do elsewhere.
constexpr double kDeadZone = 0.6;
/// Squared quanta of error that one bit is worth (the slope of D = step^2 / 12 over the rate, about).
constexpr double kEnergyPerBit = 0.12;
/// Coarsest step tried in adaptive mode, half octaves above the finest.
constexpr int kCoarsestOffset = 12;
/// Whoever leaves the usual leaves the stream's habits behind, and the blocks after it are told in worse
/// ones: only a real gain is worth that, bits.
constexpr double kRealGain = 8.0;
constexpr int kMaxFits = 5;

double squared(double x) { return x * x; }

/// Nearest integer for |x| < 2^51, ties to even, without a call.
double nearest(double x) {
  constexpr double kMagic = 0x1.8p52;
  return (x + kMagic) - kMagic;
}

}  // namespace

/// Twice integrated from rest, the mean comes to 1/2 (N Ts)^2 / sqrt(N) at the block's end, and the cosine of
/// index k to at most 2 (N Ts / pi k)^2 sqrt(2 / N).
Analyser::Analyser(int block, bool integrated)
    : block_(block), dct_(&Dct::of_size(block)), integrated_(integrated) {
  for (int k = 0; k < block; ++k) {
    weight_[static_cast<std::size_t>(k)] =
        integrated && k > 0 ? 4.0 * std::numbers::sqrt2 / squared(std::numbers::pi * k) : 1.0;
  }
  Coefficients n1{};
  Coefficients n2{};
  for (int n = 0; n < block; ++n) {
    n1[static_cast<std::size_t>(n)] = n;
    n2[static_cast<std::size_t>(n)] = 0.5 * n * n;
  }
  dct_->forward(n1, ramp_);
  dct_->forward(n2, parabola_);
}

int Analyser::fits(std::span<const double> coefficients, int from, const AxisContext& context,
                   const Grid& grid, std::span<Fit> found) const noexcept {
  int count = 0;
  const auto add = [&](Mode mode, std::int64_t slope, std::int64_t bend) {
    found[static_cast<std::size_t>(count++)] = {mode, slope, bend};
  };
  if (context.truncated) {
    add(Mode::kIntra, 0, 0);
    return count;
  }
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
  // The likely ones first: the others are then mostly dismissed without counting their bits.
  const double determinant = rr * pp - rp * rp;
  if (context.anchored) {
    const auto slope = context.trend_slope;
    add(Mode::kCurve, slope, on_grid((pc - rp * static_cast<double>(slope) * grid.slope) / pp, grid.bend));
    add(Mode::kLine, slope, 0);
  } else if (const auto slope = on_grid(rc / rr, grid.slope); slope != 0) {
    add(Mode::kLine, slope, 0);
  }
  if (determinant > 1e-9 * rr * pp) {
    const auto slope = on_grid((rc * pp - pc * rp) / determinant, grid.slope);
    const auto bend = on_grid((pc * rr - rc * rp) / determinant, grid.bend);
    if (bend != 0 && !(context.anchored && slope == context.trend_slope)) add(Mode::kCurve, slope, bend);
  }
  if (context.anchored) add(Mode::kHold, 0, 0);
  add(Mode::kIntra, 0, 0);
  return count;
}

void Analyser::residual(std::span<const double> coefficients, const AxisCode& code, double level_coefficient,
                        const Grid& grid, Coefficients& out) const noexcept {
  const double slope = code.has_slope() ? grid.slope * static_cast<double>(code.slope) : 0.0;
  const double bend = code.has_bend() ? grid.bend * static_cast<double>(code.bend) : 0.0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    out[k] = coefficients[k] - slope * ramp_[k] - bend * parabola_[k];
  }
  if (!code.has_level()) out[0] += level_coefficient;
}

void Analyser::try_fixed(std::span<const double> residual, AxisCode& code, int keep,
                         const AxisContext& context, const Grid& grid, Choice& best) const noexcept {
  if (min_step_offset(residual, grid) > 0) return;  // only an adaptive stream tells another step
  code.step_offset = 0;
  code.set = 0;
  const double least = kDeadZone * grid.step(code.step_offset);
  Coefficients counted;
  for (std::size_t k = 0; k < residual.size(); ++k) counted[k] = weight_[k] * residual[k];
  const IndexSet kept = context.truncated ? (IndexSet{2} << (std::min(keep, block_) - 1)) - 1
                                          : strongest(std::span(counted).first(residual.size()), keep);
  double energy = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const double c = residual[k];
    code.values[k] = 0;
    const double step = grid.step_of(k, code.step_offset);
    const auto value = static_cast<std::int64_t>(nearest(c / step));
    if ((kept >> k & 1) != 0 && std::abs(context.truncated ? c : counted[k]) >= least && value != 0) {
      code.values[k] = value;
      code.set |= IndexSet{1} << k;
      energy += squared(weight_[k] * (c - static_cast<double>(value) * step));
    } else {
      energy += squared(counted[k]);
    }
  }
  double cost = energy / squared(grid.level);
  if (best.found && cost >= best.cost) return;
  cost += kEnergyPerBit * newest_axis_bits(code, context, grid, block_);
  if (best.found && cost >= best.cost) return;
  best = {code, cost, true};
}

Analyser::Trial Analyser::try_adaptive(std::span<const double> residual, AxisCode& code, int offset,
                                       double max_rms, bool prefix, const AxisContext& context,
                                       const Grid& grid, Choice& best) const noexcept {
  code.step_offset = std::min(min_step_offset(residual, grid) + offset, kMaxStepOffset);
  code.set = 0;
  const double step = grid.step(code.step_offset);
  const double per_step = 1.0 / step;
  // A hair below the promise, so that rounding in the sums cannot break it.
  const double allowed = squared(max_rms) * block_ * (1.0 - 1e-9);
  std::array<double, kMaxBlock> saving{};  // error energy that sending k spares
  std::array<std::uint8_t, kMaxBlock> order{};
  int count = 0;
  double energy = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const auto value = static_cast<std::int64_t>(nearest(residual[k] * per_step));
    const double error = squared(residual[k] - static_cast<double>(value) * step);
    energy += error;
    code.values[k] = value;
    if (value == 0) continue;
    code.set |= IndexSet{1} << k;
    saving[k] = squared(residual[k]) - error;
    order[static_cast<std::size_t>(count++)] = static_cast<std::uint8_t>(k);
  }
  if (energy > allowed) return Trial::kInfeasible;
  // The least m: give up the weakest (of a prefix the highest) as long as the promise holds.
  const auto weaker = [&](std::uint8_t a, std::uint8_t b) {
    return !prefix && saving[a] != saving[b] ? saving[a] < saving[b] : a > b;
  };
  std::sort(order.begin(), order.begin() + count, weaker);
  for (int i = 0; i < count; ++i) {
    const std::size_t k = order[static_cast<std::size_t>(i)];
    if (energy + saving[k] > allowed) break;
    energy += saving[k];
    code.values[k] = 0;
    code.set &= ~(IndexSet{1} << k);
  }
  const double bits = newest_axis_bits(code, context, grid, block_);
  if (best.found && bits >= best.cost) return Trial::kDearer;
  best = {code, bits, true};
  return Trial::kTaken;
}

void Analyser::try_run_length(std::span<const double> samples, const CodingTarget& target,
                              const AxisContext& context, const Grid& grid, Choice& best) const noexcept {
  AxisCode code;
  code.mode = Mode::kRunLength;
  code.step_offset = min_step_offset(samples, grid);
  if (code.step_offset > 0 && target.max_rms == 0.0) return;
  const double step = grid.step(code.step_offset);
  // A smooth motion moves on at nearly every sample: seen at once, and nothing for run lengths.
  const double move = target.max_rms == 0.0 ? step : 2.0 * target.max_rms;
  const int most = target.max_rms == 0.0 ? target.keep : block_ / 2;
  int moves = 0;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    if (std::abs(samples[n] - samples[n - 1]) > move && ++moves > most) return;
  }
  if (target.max_rms == 0.0) {
    const double energy = hold_within(samples, {.absolute = 0.5 * step}, step, code);
    if (std::popcount(code.set) > target.keep) return;
    const double cost =
        energy / squared(grid.level) + kEnergyPerBit * newest_axis_bits(code, context, grid, block_);
    if (!best.found || cost + kEnergyPerBit * kRealGain < best.cost) best = {code, cost, true};
    return;
  }
  const double allowed = squared(target.max_rms) * block_ * (1.0 - 1e-9);
  for (const double band : {2.0, 1.4, 1.0}) {
    if (hold_within(samples, {.absolute = band * target.max_rms}, step, code) > allowed) continue;
    const double bits = newest_axis_bits(code, context, grid, block_);
    if (!best.found || bits + kRealGain < best.cost) best = {code, bits, true};
    return;
  }
}

PricedCode Analyser::analyse(std::span<const double> samples, const CodingTarget& target,
                             const AxisContext& context, const Grid& grid) const noexcept {
  Coefficients shifted;
  Coefficients transformed;
  const auto size = samples.size();
  // Numerically the trend's level goes first; an intra block gets it back in coefficient 0.
  const double level = context.anchored ? grid.level * static_cast<double>(context.trend_level) : 0.0;
  for (std::size_t n = 0; n < size; ++n) shifted[n] = samples[n] - level;
  dct_->forward(std::span(shifted).first(size), transformed);
  const auto coefficients = std::span<const double>(transformed).first(size);
  const double level_coefficient = level * std::sqrt(block_);

  std::array<Fit, kMaxFits> found;
  const int from = target.max_rms > 0.0 ? 2 : std::min(target.keep / 2 + 1, block_ - 2);
  const int count = fits(coefficients, from, context, grid, found);
  Coefficients room;
  const auto part = std::span<const double>(room).first(size);
  Choice best;
  AxisCode code;
  code.level = context.trend_level;
  const bool adaptive = target.max_rms > 0.0;
  const auto adapt = [&](int offset, bool prefix) {
    return try_adaptive(part, code, offset, target.max_rms, prefix, context, grid, best);
  };
  const int usual = std::min(context.model.step_offset, kCoarsestOffset);
  for (int i = 0; i < count; ++i) {
    const auto& fit = found[static_cast<std::size_t>(i)];
    code.mode = fit.mode;
    code.slope = fit.slope;
    code.bend = fit.bend;
    residual(coefficients, code, level_coefficient, grid, room);
    if (!adaptive) {
      try_fixed(part, code, target.keep, context, grid, best);
    } else {
      for (const bool prefix : {false, true}) {
        if (prefix ? fit.mode != Mode::kIntra : context.truncated) continue;
        for (int offset = usual; offset >= 0 && adapt(offset, prefix) == Trial::kInfeasible; --offset) {
        }
      }
    }
  }
  if (adaptive && best.found) {
    // Coarser or finer steps for the best prediction, as long as that pays.
    code = best.code;
    residual(coefficients, code, level_coefficient, grid, room);
    const int middle = best.code.step_offset - min_step_offset(part, grid);
    for (const int direction : {1, -1}) {
      for (int offset = middle + direction; offset >= 0 && offset <= kCoarsestOffset; offset += direction) {
        bool better = !context.truncated && adapt(offset, false) == Trial::kTaken;
        if (code.mode == Mode::kIntra) better = adapt(offset, true) == Trial::kTaken || better;
        if (!better) break;
      }
    }
  }
  if (!context.truncated && !(integrated_ && !adaptive)) try_run_length(samples, target, context, grid, best);
  const double bits =
      !best.found ? 0 : (adaptive ? best.cost : newest_axis_bits(best.code, context, grid, block_));
  if (best.found && bits <= kRawSampleBits * block_) {
    return {best.code, adaptive ? best.cost : best.cost / kEnergyPerBit};
  }
  const AxisCode raw = raw_code(samples);
  return {raw, static_cast<double>(newest_axis_bits(raw, context, grid, block_))};
}

}  // namespace telekerf::codec
