// SPDX-License-Identifier: Apache-2.0
#include "common/codec/run_length.h"

#include <algorithm>
#include <bit>

namespace telekerf::codec {
namespace {

constexpr int kRunStepOrder = 2;  // Exp-Golomb, of a change
constexpr int kRunOrder = 1;

template <typename Sink>
void write_any_runs(Sink& out, const AxisCode& code) noexcept {
  out.golomb(static_cast<std::uint64_t>(std::popcount(code.set & ~IndexSet{1})), kRunOrder);
  std::size_t last = 0;
  int order = kRunStepOrder;
  for (auto set = code.set & ~IndexSet{1}; set != 0; set &= set - 1) {
    const auto n = static_cast<std::size_t>(std::countr_zero(set));
    const auto step = code.values[n] - code.values[last];
    out.golomb(n - last - 1, kRunOrder);
    out.signed_golomb(step, order);
    order = std::clamp(static_cast<int>(std::bit_width(zigzag(step))) - 2, 0, 31);
    last = n;
  }
}

}  // namespace

double hold_within(std::span<const double> samples, const Band& band, double step, AxisCode& code) noexcept {
  double energy = 0.0;
  double kept = 0.0;
  code.set = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (n == 0 || std::abs(samples[n] - kept) > band.absolute + band.relative * std::abs(kept)) {
      code.values[n] = static_cast<std::int64_t>(std::llround(samples[n] / step));
      if (n == 0 || code.values[n] != code.values[n - 1]) code.set |= IndexSet{1} << n;
      kept = static_cast<double>(code.values[n]) * step;
    } else {
      code.values[n] = code.values[n - 1];
    }
    energy += (samples[n] - kept) * (samples[n] - kept);
  }
  return energy;
}

void write_runs(BitWriter& out, const AxisCode& code) noexcept { write_any_runs(out, code); }
void write_runs(BitCounter& out, const AxisCode& code) noexcept { write_any_runs(out, code); }

bool read_runs(BitReader& in, AxisCode& code, int block) noexcept {
  auto& v = code.values;
  auto events = in.golomb(kRunOrder);
  if (in.failed() || events >= static_cast<std::uint64_t>(block)) return false;
  std::size_t last = 0;
  int order = kRunStepOrder;
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

}  // namespace telekerf::codec
