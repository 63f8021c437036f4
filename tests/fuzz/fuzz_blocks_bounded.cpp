// SPDX-License-Identifier: Apache-2.0
// The fuzz target of blocks without libFuzzer: a fixed number of seeded mutations of blocks of both streams.
// Usage: [ROUNDS [SEED]]
#include <array>
#include <cstdio>
#include <cstdlib>

#include "common/protocol/contract_version.h"
#include "common/protocol/header_compression.h"
#include "tests/fuzz/mutations.h"
#include "tests/unit/bus/samples.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using namespace telekerf;
using fuzz::Bytes;
using fuzz::Random;

/// Blocks in their order, with their sets and without, each with the target's leading byte.
template <class Block, class Make>
void add(std::vector<Bytes>& all, std::uint8_t leading, const Make& make) {
  HeaderCompressor<Block> sender;
  std::array<std::uint8_t, kMaxStateBytes> room{};
  for (std::uint32_t n = 0; n < 200; ++n) {
    const auto bytes = sender.compress(make(n), kContractVersion, room);
    Bytes entry{leading};
    entry.insert(entry.end(), bytes.begin(), bytes.end());
    all.push_back(entry);
  }
}

std::vector<Bytes> corpus() {
  std::vector<Bytes> all;
  for (const auto sender : {std::uint8_t{0}, std::uint8_t{2}}) {
    samples::Random random(5);
    const CommandBlock command = samples::command(random, 40);
    const StateBlock state = samples::state(random, 60);
    const auto next = [](auto block, std::uint32_t n) {
      block.sequence = n;
      block.sample_period_ns = 1'000'000;
      block.sent_ns = 16'000'000LL * n;
      block.echo_sequence = n;
      block.echo_sent_ns = 16'000'000LL * n;
      return block;
    };
    add<CommandBlock>(all, static_cast<std::uint8_t>(sender | 1),
                      [&](std::uint32_t n) { return next(command, n); });
    add<StateBlock>(all, sender, [&](std::uint32_t n) { return next(state, n); });
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const long rounds = argc > 1 ? std::atol(argv[1]) : 200'000;
  Random random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  const auto blocks = corpus();
  std::size_t at = 0;
  for (long round = 0; round < rounds; ++round) {
    // Mostly in their order, so that short forms have what they lean on.
    at = random() % 8 == 0 ? random() % blocks.size() : (at + 1) % blocks.size();
    Bytes bytes = blocks[at];
    if (random() % 2 == 0) fuzz::mutate(bytes, random);
    if (!bytes.empty() && random() % 4 == 0) bytes[0] |= 4;  // what it says, sealed
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%ld mutated blocks restored or refused\n", rounds);
  return 0;
}
