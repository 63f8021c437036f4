// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/dpcm.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/codec/baselines/time_domain.h"

namespace telekerf::codec {
namespace {

constexpr int kMaxRiceOrder = 31;  // 5 bits
constexpr int kMaxUnary = 20;      // longer quotients escape to an Exp-Golomb code

template <typename Sink>
void write_rice(Sink& out, std::uint64_t value, int order) noexcept {
  const auto quotient = value >> order;
  if (quotient >= kMaxUnary) {
    out.bits((1U << kMaxUnary) - 1U, kMaxUnary);
    out.golomb(value, order);
    return;
  }
  const auto ones = static_cast<int>(quotient);
  out.bits((std::uint64_t{2} << ones) - 2, ones + 1);
  out.bits(value, order);
}

std::uint64_t read_rice(BitReader& in, int order) noexcept {
  int ones = 0;
  while (ones < kMaxUnary && in.bit()) ++ones;
  if (ones == kMaxUnary) return in.golomb(order);
  return (static_cast<std::uint64_t>(ones) << order) | in.bits(order);
}

/// d-th difference at n >= d; earlier ones are taken by the lower orders.
std::int64_t difference(const AxisCode& code, int degree, std::size_t n) noexcept {
  const auto& v = code.values;
  if (n == 0 || degree == 0) return v[n];
  if (n == 1 || degree == 1) return v[n] - v[n - 1];
  return v[n] - 2 * v[n - 1] + v[n - 2];
}

template <typename Sink>
void write_residuals(Sink& out, const AxisCode& code, int degree, int order, int block) noexcept {
  out.bits(static_cast<std::uint64_t>(degree), 2);
  out.bits(static_cast<std::uint64_t>(order), 5);
  out.signed_golomb(code.values[0], kFirstOrder);
  for (std::size_t n = 1; n < static_cast<std::size_t>(block); ++n) {
    write_rice(out, zigzag(difference(code, degree, n)), order);
  }
}

/// The Rice order that fits the mean magnitude, about.
int rice_order(const AxisCode& code, int degree, int block) noexcept {
  std::uint64_t sum = 0;
  for (std::size_t n = 1; n < static_cast<std::size_t>(block); ++n)
    sum += zigzag(difference(code, degree, n));
  const auto mean = sum / static_cast<std::uint64_t>(std::max(block - 1, 1));
  return std::clamp(static_cast<int>(std::bit_width(mean)) - 1, 0, kMaxRiceOrder);
}

template <typename Sink>
void write_dpcm(Sink& out, const AxisCode& code, int block) noexcept {
  int best_degree = 0;
  int best_order = 0;
  int best_bits = std::numeric_limits<int>::max();
  for (int degree = 0; degree <= 2; ++degree) {
    const int guess = rice_order(code, degree, block);
    for (int order = std::max(guess - 1, 0); order <= std::min(guess + 1, kMaxRiceOrder); ++order) {
      BitCounter counter;
      write_residuals(counter, code, degree, order, block);
      if (counter.count() >= best_bits) continue;
      best_bits = counter.count();
      best_degree = degree;
      best_order = order;
    }
  }
  write_residuals(out, code, best_degree, best_order, block);
}

bool read_dpcm(BitReader& in, AxisCode& code, int block) noexcept {
  const auto degree = static_cast<int>(in.bits(2));
  const auto order = static_cast<int>(in.bits(5));
  if (degree > 2) return false;
  auto& v = code.values;
  v[0] = in.signed_golomb(kFirstOrder);
  if (in.failed() || std::abs(v[0]) > kMaxValue) return false;
  for (std::size_t n = 1; n < static_cast<std::size_t>(block); ++n) {
    const auto step = unzigzag(read_rice(in, order));
    if (in.failed() || std::abs(step) > 4 * kMaxValue) return false;
    v[n] = step + (degree == 0 ? 0 : (n == 1 || degree == 1 ? v[n - 1] : 2 * v[n - 1] - v[n - 2]));
    if (std::abs(v[n]) > kMaxValue) return false;
  }
  return true;
}

/// Rounds to the lattice and returns the squared error.
double round_all(std::span<const double> samples, double step, AxisCode& code) noexcept {
  double energy = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const auto value = static_cast<std::int64_t>(std::llround(samples[n] / step));
    const double error = samples[n] - static_cast<double>(value) * step;
    code.values[n] = value;
    energy += error * error;
  }
  return energy;
}

const auto write_coded = [](auto& out, const AxisCode& code, int block) noexcept {
  write_dpcm(out, code, block);
};

CodedAxis encode(std::span<double> samples, const EncoderTools& tools, const AxisContext&) noexcept {
  constexpr int kCoarser = 4;  // half octaves tried above the finest step
  AxisCode code;
  const int least = min_step_offset(samples, tools.grid);
  bool kept = false;
  if (tools.settings.max_rms == 0.0) {
    kept = least == 0;  // only an adaptive stream tells another step
    if (kept) round_all(samples, tools.grid.step(0), code);
    return coded_or_raw(code, kept, samples, tools, write_coded);
  }
  for (int offset = least + kCoarser; offset >= least && !kept; --offset) {
    code.step_offset = offset;
    kept = round_all(samples, tools.grid.step(offset), code) <= allowed_energy(samples, tools.settings);
  }
  return coded_or_raw(code, kept, samples, tools, write_coded);
}

}  // namespace

const AxisCodec kDpcmCodec{
    .kind = kDpcm,
    .step_per_rms = kTimeDomainStepPerRms,
    .encode = encode,
    .write =
        [](BitWriter& out, const CodedAxis& axis, const AxisContext& context, const Grid&,
           int block) noexcept { write_multiples(out, axis.code, context.adaptive, block, write_coded); },
    .read =
        [](BitReader& in, const AxisContext& context, const Grid& grid, Successor&,
           std::span<double> samples) noexcept {
          return read_multiples(in, context.adaptive, grid, samples, read_dpcm);
        },
};

}  // namespace telekerf::codec
