// SPDX-License-Identifier: Apache-2.0
// The fuzz target without libFuzzer: a fixed number of seeded mutations of packets of every kind. Usage:
// [ROUNDS [SEED]]
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "common/codec/encoder.h"
#include "tests/fuzz/mutations.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using telekerf::Vec3;

using telekerf::fuzz::Bytes;
using telekerf::fuzz::mutate;
using telekerf::fuzz::Random;

/// Packets of every codec, block length and mode, each with the target's leading byte.
std::vector<Bytes> corpus() {
  using namespace telekerf::codec;
  std::vector<Bytes> all;
  Random random(5);
  for (const auto& name : codec_names()) {
    for (const int block : {4, 15, 16, 64}) {
      for (const bool anchored : {false, true}) {
        for (const double max_rms : {0.0, 1e-3}) {
          StreamSettings wanted{.block = block,
                                .max_rms = max_rms,
                                .redundancy = block == 64 ? 1 : 3,
                                .quantum = 1e-3,
                                .anchored = anchored};
          wanted.threshold = 0.01;
          BlockEncoder encoder(with_codec(wanted, name));
          std::vector<Vec3> samples(static_cast<std::size_t>(encoder.settings().block));
          Bytes packet(8192);
          for (int b = 0; b < 4; ++b) {
            for (auto& sample : samples)
              sample = Vec3::Constant(1.0) * static_cast<double>(random() % 1000) * 1e-3;
            packet.resize(8192);
            packet.resize(encoder.encode(samples, random(), {}, packet).value_or(0));
            Bytes entry{static_cast<std::uint8_t>(random())};
            entry.insert(entry.end(), packet.begin(), packet.end());
            all.push_back(entry);
          }
        }
      }
    }
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const long rounds = argc > 1 ? std::atol(argv[1]) : 200'000;
  Random random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  const auto seeds = corpus();
  for (long round = 0; round < rounds; ++round) {
    auto bytes = seeds[random() % seeds.size()];
    mutate(bytes, random);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%ld mutated packets decoded or refused\n", rounds);
  return 0;
}
