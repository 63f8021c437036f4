// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/time_domain_codecs.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "common/codec/axis_bits.h"

namespace telekerf::codec {
namespace {

constexpr int kFirstOrder = 10;    // Exp-Golomb order of a block's first, whole integer
constexpr int kMaxRiceOrder = 31;  // 5 bits
constexpr int kMaxUnary = 20;      // longer quotients escape to an Exp-Golomb code
constexpr int kEventOrder = 2;     // of a dead-band's differences
constexpr int kRunOrder = 1;
constexpr int kWidestBand = 12;  // half octaves tried above and below the promised error

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
void write_differences(Sink& out, const AxisCode& code, int degree, int order, int block) noexcept {
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
      write_differences(counter, code, degree, order, block);
      if (counter.count() >= best_bits) continue;
      best_bits = counter.count();
      best_degree = degree;
      best_order = order;
    }
  }
  write_differences(out, code, best_degree, best_order, block);
}

template <typename Sink>
void write_any_runs(Sink& out, const AxisCode& code) noexcept {
  out.golomb(static_cast<std::uint64_t>(std::popcount(code.set & ~IndexSet{1})), kRunOrder);
  std::size_t last = 0;
  int order = kEventOrder;
  for (auto set = code.set & ~IndexSet{1}; set != 0; set &= set - 1) {
    const auto n = static_cast<std::size_t>(std::countr_zero(set));
    const auto step = code.values[n] - code.values[last];
    out.golomb(n - last - 1, kRunOrder);
    out.signed_golomb(step, order);
    order = std::clamp(static_cast<int>(std::bit_width(zigzag(step))) - 2, 0, 31);
    last = n;
  }
}

template <typename Sink>
void write_any(Sink& out, const LatticeKind& kind, const AxisCode& code, int block) noexcept {
  out.bits(code.mode == Mode::kRaw ? 1 : 0, 1);
  if (code.mode == Mode::kRaw) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(block); ++n) {
      out.bits(std::bit_cast<std::uint32_t>(code.raw[n]), 32);
    }
    return;
  }
  if (kind.adaptive) out.golomb(static_cast<std::uint64_t>(code.step_offset), 0);
  if (kind.codec == CodecKind::kDpcm) {
    write_dpcm(out, code, block);
  } else {
    out.signed_golomb(code.values[0], kFirstOrder);
    write_runs(out, code);
  }
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

/// The same with a band that may grow with the value last sent.
double hold(std::span<const double> samples, bool weber, double threshold, double step,
            AxisCode& code) noexcept {
  double energy = 0.0;
  double sent = 0.0;
  code.set = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double band = weber ? threshold * std::abs(sent) : threshold;
    if (n == 0 || std::abs(samples[n] - sent) > band) {
      code.values[n] = static_cast<std::int64_t>(std::llround(samples[n] / step));
      if (n == 0 || code.values[n] != code.values[n - 1]) code.set |= IndexSet{1} << n;
      sent = static_cast<double>(code.values[n]) * step;
    } else {
      code.values[n] = code.values[n - 1];
    }
    energy += (samples[n] - sent) * (samples[n] - sent);
  }
  return energy;
}

int smallest_offset(std::span<const double> samples, const Grid& grid) noexcept {
  double largest = 0.0;
  for (const double x : samples) largest = std::max(largest, std::abs(x));
  int offset = 0;
  while (largest >= 0.5 * static_cast<double>(kMaxValue) * grid.step(offset) && offset < kMaxStepOffset)
    ++offset;
  return offset;
}

}  // namespace

double hold_within(std::span<const double> samples, double band, double step, AxisCode& code) noexcept {
  return hold(samples, false, band, step, code);
}

void write_runs(BitWriter& out, const AxisCode& code) noexcept { write_any_runs(out, code); }
void write_runs(BitCounter& out, const AxisCode& code) noexcept { write_any_runs(out, code); }

bool read_runs(BitReader& in, AxisCode& code, int block) noexcept {
  auto& v = code.values;
  auto events = in.golomb(kRunOrder);
  if (in.failed() || events >= static_cast<std::uint64_t>(block)) return false;
  std::size_t last = 0;
  int order = kEventOrder;
  code.set = 1;
  for (; events > 0; --events) {
    const auto run = in.golomb(kRunOrder);
    const auto step = in.signed_golomb(order);
    if (in.failed() || run >= static_cast<std::uint64_t>(block) - last - 1) return false;
    const auto n = last + static_cast<std::size_t>(run) + 1;
    for (auto held = last + 1; held < n; ++held) v[held] = v[last];
    if (std::abs(step) > 4 * kMaxValue) return false;
    v[n] = v[last] + step;
    if (std::abs(v[n]) > 8 * kMaxValue) return false;
    order = std::clamp(static_cast<int>(std::bit_width(zigzag(step))) - 2, 0, 31);
    code.set |= IndexSet{1} << n;
    last = n;
  }
  for (auto held = last + 1; held < static_cast<std::size_t>(block); ++held) v[held] = v[last];
  return true;
}

namespace {

AxisCode raw_code(std::span<const double> samples) noexcept {
  AxisCode code;
  code.mode = Mode::kRaw;
  for (std::size_t n = 0; n < samples.size(); ++n) code.raw[n] = static_cast<float>(samples[n]);
  return code;
}

}  // namespace

AxisCode analyse_lattice(std::span<const double> samples, const StreamSettings& settings,
                         const Grid& grid) noexcept {
  AxisCode code;
  const int least = smallest_offset(samples, grid);
  const bool weber = settings.kind == CodecKind::kWeber;
  const double allowed =
      settings.max_rms * settings.max_rms * static_cast<double>(samples.size()) * (1.0 - 1e-9);
  code.step_offset = least;
  bool kept = settings.max_rms == 0.0;
  if (kept && least > 0) return raw_code(samples);  // only an adaptive stream tells another step
  if (settings.kind == CodecKind::kDpcm) {
    if (kept) {
      round_all(samples, grid.step(least), code);
    } else {
      for (int offset = least + 4; offset >= least && !kept; --offset) {
        code.step_offset = offset;
        kept = round_all(samples, grid.step(offset), code) <= allowed;
      }
    }
  } else if (kept) {
    hold(samples, weber, settings.threshold, grid.step(least), code);
  } else {
    for (int widen = kWidestBand; widen >= -kWidestBand && !kept; --widen) {
      const double band = Grid::fractional_power(settings.max_rms, 2 * widen);
      // Weber: the fraction that makes this band at the block's largest sample.
      double largest = 0.0;
      for (const double x : samples) largest = std::max(largest, std::abs(x));
      const double threshold = weber && largest > 0.0 ? band / largest : band;
      kept = hold(samples, weber, threshold, grid.step(least), code) <= allowed;
    }
  }
  BitCounter counter;
  write_any(counter, {settings.kind, settings.max_rms > 0.0}, code, static_cast<int>(samples.size()));
  constexpr int kFloatBits = 32;
  if (kept && counter.count() <= kFloatBits * static_cast<int>(samples.size())) return code;
  return raw_code(samples);
}

void write_lattice(BitWriter& out, const LatticeKind& kind, const AxisCode& code, int block) noexcept {
  write_any(out, kind, code, block);
}

bool read_lattice(BitReader& in, const LatticeKind& kind, AxisCode& code, int block) noexcept {
  if (in.bit()) {
    code.mode = Mode::kRaw;
    for (std::size_t n = 0; n < static_cast<std::size_t>(block); ++n) {
      code.raw[n] = std::bit_cast<float>(static_cast<std::uint32_t>(in.bits(32)));
      if (!(std::abs(code.raw[n]) <= static_cast<float>(kMaxMagnitude))) return false;
    }
    return !in.failed();
  }
  const auto offset = kind.adaptive ? in.golomb(0) : 0;
  if (in.failed() || offset > kMaxStepOffset) return false;
  code.step_offset = static_cast<int>(offset);
  if (kind.codec == CodecKind::kDpcm) return read_dpcm(in, code, block);
  code.values[0] = in.signed_golomb(kFirstOrder);
  return !in.failed() && std::abs(code.values[0]) <= kMaxValue && read_runs(in, code, block);
}

void reconstruct_lattice(const AxisCode& code, const Grid& grid, std::span<double> samples) noexcept {
  const double step = grid.step(code.step_offset);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n] = code.mode == Mode::kRaw ? static_cast<double>(code.raw[n])
                                         : step * static_cast<double>(code.values[n]);
  }
}

}  // namespace telekerf::codec
