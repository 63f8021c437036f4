// SPDX-License-Identifier: Apache-2.0
// Time to encode and decode a 3-axis block, and transform + selection beside FFTW's REDFT10 + std::sort in
// the same run.
//
// Method: blocks of the seeded hand and force traces, every call another block. A round times all blocks of
// one contender in this thread's CPU time, and contenders take turns; the first rounds warm up. Given are the
// median, the 99th percentile and the largest of the rounds' means. The selection keeps 4 of N; std::sort
// orders N indices by magnitude. Exit code 1: slower than FFTW + sort, or 10 us exceeded for N = 32 with
// default settings.
#include <fmt/format.h>
#ifdef TELEKERF_WITH_FFTW
#include <fftw3.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <numeric>
#include <vector>

#include "common/codec/dct.h"
#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/codec/selection.h"
#include "experiments/codec/codec_traces.h"

namespace telekerf::codec {
namespace {

constexpr int kRounds = 101;
constexpr int kWarmUp = 10;
constexpr int kKeep = 4;
constexpr double kBlockBudgetNs = 10'000;

double cpu_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

struct Times {
  double median = 0, p99 = 0, largest = 0;
};

/// Times of one call, from rounds over all items; contenders alternate.
std::vector<Times> race(std::size_t items, const std::vector<std::function<void(std::size_t)>>& contenders) {
  std::vector<std::vector<double>> means(contenders.size());
  for (int round = 0; round < kRounds + kWarmUp; ++round) {
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      const double start = cpu_ns();
      for (std::size_t i = 0; i < items; ++i) contenders[c](i);
      const double mean = (cpu_ns() - start) / static_cast<double>(items);
      if (round >= kWarmUp) means[c].push_back(mean);
    }
  }
  std::vector<Times> times;
  for (auto& row : means) {
    std::sort(row.begin(), row.end());
    times.push_back({row[row.size() / 2], row[row.size() * 99 / 100], row.back()});
  }
  return times;
}

void print(const std::string& what, const Times& t) {
  fmt::print("{:<52}{:>10.0f}{:>10.0f}{:>10.0f}\n", what, t.median, t.p99, t.largest);
}

struct Blocks {
  std::vector<std::vector<Vec3>> samples;
  std::vector<Trend> trends;
};

Blocks blocks_of(const Trace& trace, int block) {
  Blocks all;
  const auto size = static_cast<std::size_t>(block);
  for (std::size_t at = size; at + size <= trace.size(); at += size) {
    std::vector<Vec3> samples(size);
    Trend trend;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto& x = trace.values[a];
      const auto axis = static_cast<Eigen::Index>(a);
      for (std::size_t n = 0; n < size; ++n) samples[n][axis] = x[at + n];
      trend.value[axis] = static_cast<double>(static_cast<float>(x[at]));
      trend.slope_per_sample[axis] = (x[at] - x[at - 4]) / 4;
    }
    all.samples.push_back(samples);
    all.trends.push_back(trend);
  }
  return all;
}

/// Encode and decode; returns the sum of the medians.
double block_times(const std::string& what, const Blocks& blocks, const StreamSettings& settings) {
  BlockEncoder encoder(settings);
  BlockDecoder decoder;
  const auto items = blocks.samples.size();
  std::vector<std::vector<std::uint8_t>> packets(items, std::vector<std::uint8_t>(4096));
  std::vector<std::size_t> sizes(items);
  const auto times = race(
      items, {[&](std::size_t i) {
                sizes[i] = encoder.encode(blocks.samples[i], 0, blocks.trends[i], packets[i]).value_or(0);
              },
              [&](std::size_t i) {
                const auto packet = std::span(packets[i]).first(sizes[i]);
                if (!decoder.decode(packet, blocks.trends[i])) std::abort();
              }});
  print(what + " encode", times[0]);
  print(what + " decode", times[1]);
  return times[0].median + times[1].median;
}

/// One axis: transform and selection against FFTW; returns ours / theirs (0 without FFTW).
double against_fftw(const Trace& trace, int block) {
  const auto size = static_cast<std::size_t>(block);
  const auto items = trace.size() / size;
  const auto& x = trace.values[0];
  const auto& dct = Dct::of_size(block);
  std::vector<double> coefficients(size);
  volatile IndexSet sink = 0;
  std::vector<std::function<void(std::size_t)>> contenders{[&](std::size_t i) {
    dct.forward(std::span(x).subspan(i * size, size), coefficients);
    sink = sink + strongest(coefficients, kKeep);
  }};
#ifdef TELEKERF_WITH_FFTW
  auto* in = fftw_alloc_real(size);
  auto* out = fftw_alloc_real(size);
  fftw_plan plan = fftw_plan_r2r_1d(block, in, out, FFTW_REDFT10, FFTW_PATIENT);
  std::vector<int> order(size);
  contenders.push_back([&](std::size_t i) {
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(i * size), size, in);
    fftw_execute(plan);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(out[a]) > std::abs(out[b]); });
    sink = sink + (IndexSet{1} << order[0]);
  });
#endif
  const auto times = race(items, contenders);
  print(fmt::format("{} N={}: transform + selection", trace.name, block), times[0]);
  if (times.size() < 2) return 0;
  print(fmt::format("{} N={}: FFTW REDFT10 + std::sort", trace.name, block), times[1]);
#ifdef TELEKERF_WITH_FFTW
  fftw_destroy_plan(plan);
  fftw_free(in);
  fftw_free(out);
#endif
  return times[0].median / times[1].median;
}

int run() {
  fmt::print("{:<52}{:>10}{:>10}{:>10}\n", "ns a call (CPU time)", "median", "p99", "max");
  bool good = true;
  for (const auto& seeded : experiments::seeded_traces(6.0, 1000.0, 1)) {
    const auto& trace = seeded.trace;
    if (trace.name != "hand" && trace.name != "force" && trace.name != "noise") continue;
    for (const int block : {16, 32, 64}) {
      const double ratio = against_fftw(trace, block);
      if (ratio > 0) fmt::print("{:<52}{:>10.2f}\n", "  ours / FFTW + sort", ratio);
      good = good && ratio <= 1.0;
    }
    if (trace.name == "noise") continue;
    const auto blocks = blocks_of(trace, 32);
    const StreamSettings fixed{.block = 32, .quantum = seeded.fine, .anchored = seeded.is_position};
    auto adaptive = fixed;
    adaptive.max_rms = seeded.fine;
    const double total = block_times(trace.name + " N=32 R=1 keep 4:", blocks, fixed);
    good = good && total < kBlockBudgetNs;
    fmt::print("{:<52}{:>10.0f}\n", "  encode + decode", total);
    (void)block_times(trace.name + " N=32 R=1 adaptive:", blocks, adaptive);
  }
  fmt::print("{}\n", good ? "within its bars" : "a bar is missed");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace telekerf::codec

int main() { return telekerf::codec::run(); }
