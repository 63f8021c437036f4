// SPDX-License-Identifier: Apache-2.0
// Whatever the signal: SDCT's stream never costs more than truncation's with the same settings.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/codec/baselines/truncated_dct.h"
#include "common/codec/encoder.h"

namespace telekerf::codec {
namespace {

using std::numbers::pi;
using Signal = std::function<double(int)>;

constexpr double kHair_bits = 0.05;  // a block and axis
constexpr int kSamples = 9600;

struct Named {
  std::string name;
  Signal at;
};

std::vector<double> noise(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, size);
  std::vector<double> all(kSamples);
  for (double& each : all) each = normal(random);
  return all;
}

std::vector<Named> signals() {
  std::vector<double> walk = noise(3, 3e-6);
  for (std::size_t n = 1; n < walk.size(); ++n) walk[n] += walk[n - 1];
  // Habits are worth nothing here: another kind of signal begins every 40 samples.
  std::vector<double> patches = noise(4, 1.0);
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const auto kind = (n / 40) % 4;
    const auto phase = static_cast<double>(n % 40);
    patches[n] = kind == 0 ? 1e-3 : kind == 1 ? 2e-5 * phase : kind == 2 ? 1e-5 * patches[n] : 0.0;
  }
  return {
      {"constant", [](int) { return 0.0123456; }},
      {"zero", [](int) { return 0.0; }},
      {"ramp", [](int n) { return 3.7e-6 * n; }},
      {"square", [](int n) { return (n / 37) % 2 == 0 ? 1e-3 : -1e-3; }},
      {"slow square", [](int n) { return (n / 400) % 2 == 0 ? 1e-3 : -1e-3; }},
      {"jumps, then held", [](int n) { return n < 400 ? 1e-3 * ((n * 7919) % 13) : 0.0123456; }},
      {"stairs", [](int n) { return 4e-5 * (n / 11); }},
      {"sine 1 Hz", [](int n) { return 0.01 * std::sin(2 * pi * 1e-3 * n); }},
      {"sine 50 Hz", [](int n) { return 1e-3 * std::sin(2 * pi * 50e-3 * n); }},
      {"sine 333 Hz", [](int n) { return 1e-3 * std::sin(2 * pi * 333e-3 * n); }},
      {"chirp", [](int n) { return 1e-3 * std::sin(2e-5 * n * n); }},
      {"impulses", [](int n) { return n % 61 == 0 ? 1e-3 : 0.0; }},
      {"noise", [all = noise(2, 1e-5)](int n) { return all[static_cast<std::size_t>(n)]; }},
      {"walk", [walk](int n) { return walk[static_cast<std::size_t>(n)]; }},
      {"patches", [patches](int n) { return patches[static_cast<std::size_t>(n)]; }},
  };
}

struct Cost {
  double bits = 0.0;           ///< a block and axis, the head without
  double energy_quanta = 0.0;  ///< a block and axis: squared error in squared quanta
};

Cost cost(StreamSettings settings, CodecKind kind, const Signal& signal) {
  settings.kind = kind;
  BlockEncoder encoder(settings);
  std::vector<std::uint8_t> room(4096);
  std::vector<Vec3> samples(static_cast<std::size_t>(settings.block));
  Cost sum;
  const int blocks = kSamples / settings.block;
  for (int b = 0; b < blocks; ++b) {
    for (int n = 0; n < settings.block; ++n) {
      samples[static_cast<std::size_t>(n)] = Vec3(signal(b * settings.block + n), 0.0, 0.0);
    }
    EXPECT_TRUE(encoder.encode(samples, 0, {}, room).has_value());
    sum.bits += static_cast<double>(encoder.newest_block_bits());
    for (std::size_t n = 0; n < samples.size(); ++n) {
      sum.energy_quanta += std::pow((samples[n].x() - encoder.decoded()[n].x()) / settings.quantum, 2);
    }
  }
  return {sum.bits / blocks, sum.energy_quanta / blocks};
}

StreamSettings stream(int block) {
  StreamSettings settings;
  settings.block = block;
  settings.redundancy = 0;
  settings.axes = 1;
  settings.anchored = false;
  return settings;
}

TEST(Sdct, NeverCostsMoreBitsThanTruncationForAPromisedError) {
  for (const Named& signal : signals()) {
    for (const int block : {4, 8, 16, 32, 64}) {
      for (const double rms : {2e-7, 1e-6, 5e-6, 4e-5}) {
        StreamSettings settings = stream(block);
        settings.max_rms = rms;
        const Cost sdct = cost(settings, kSdct, signal.at);
        const Cost truncated = cost(settings, kTruncatedDct, signal.at);
        EXPECT_LE(sdct.bits, truncated.bits + kHair_bits)
            << signal.name << ", N = " << block << ", RMS " << rms;
      }
    }
  }
}

/// With a number of coefficients the error counts as well: a bit is worth 0.12 squared quanta.
TEST(Sdct, NeverCostsMoreThanTruncationWithTheSameNumberOfCoefficients) {
  for (const Named& signal : signals()) {
    for (const int block : {4, 8, 16, 32, 64}) {
      for (const int keep : {1, 4, block}) {
        StreamSettings settings = stream(block);
        settings.keep = std::min(keep, block);
        const Cost sdct = cost(settings, kSdct, signal.at);
        const Cost truncated = cost(settings, kTruncatedDct, signal.at);
        EXPECT_LE(sdct.bits + sdct.energy_quanta / 0.12,
                  truncated.bits + truncated.energy_quanta / 0.12 + kHair_bits)
            << signal.name << ", N = " << block << ", keep " << keep << ": " << sdct.bits << " bits for "
            << sdct.energy_quanta << ", truncation " << truncated.bits << " for " << truncated.energy_quanta;
      }
    }
  }
}

}  // namespace
}  // namespace telekerf::codec
