// SPDX-License-Identifier: Apache-2.0
// The emulator's promises, whatever the profile: nothing early, nothing altered unless it says so, order as
// asked.
#include "netem/core/emulator.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace telekerf::netem {
namespace {

constexpr std::int64_t kMs = 1'000'000;

DirectionProfile both(const std::string& keys, const std::string& rest = "") {
  return parse_profile("[both]\n" + keys + "\n" + rest, "test").forward;
}

std::vector<std::byte> random_bytes(std::mt19937& random, std::size_t size) {
  std::vector<std::byte> bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::byte>(random() & 0xFF);
  return bytes;
}

TEST(Emulator, ConstantDelayIsExactAndNeverEarly) {
  Emulator emulator(both("delay_ms = 50"), {1, 0, Direction::kForward});
  const PacketOutcome outcome = emulator.push(7, 100U, 42);
  EXPECT_EQ(outcome.due_ns, 7 + 50 * kMs);
  EXPECT_EQ(emulator.next_deadline(), outcome.due_ns);
  EXPECT_FALSE(emulator.pop(outcome.due_ns - 1));
  const auto delivery = emulator.pop(outcome.due_ns);
  ASSERT_TRUE(delivery);
  EXPECT_EQ(delivery->tag, 42U);
  EXPECT_EQ(delivery->in_ns, 7);
  EXPECT_EQ(delivery->size, 100U);
  EXPECT_FALSE(emulator.next_deadline());
}

TEST(Emulator, PayloadOfEverySizeComesOutAsItWentIn) {
  std::mt19937 random(3);
  Emulator emulator(both("delay_ms = 20\njitter_ms = 8\ndistribution = \"normal\"\norder = \"free\""), {5});
  std::vector<std::vector<std::byte>> sent;
  std::size_t received = 0;
  const auto receive = [&](std::int64_t now_ns) {
    while (const auto delivery = emulator.pop(now_ns)) {
      const auto& expected = sent[delivery->tag];
      ASSERT_EQ(delivery->bytes.size(), expected.size());
      ASSERT_EQ(std::memcmp(delivery->bytes.data(), expected.data(), expected.size()), 0)
          << "packet " << delivery->tag;
      ++received;
    }
  };
  for (std::int64_t i = 0; i < 3000; ++i) {
    const std::size_t sizes[] = {1, 511, 512, 513, 1 + random() % 1500, 1 + random() % 65536};
    sent.push_back(random_bytes(random, sizes[random() % 6]));
    emulator.push(i * kMs, sent.back(), static_cast<std::uint64_t>(i));
    receive(i * kMs);
  }
  receive(10'000 * kMs);
  EXPECT_EQ(received, sent.size());
  EXPECT_EQ(emulator.counters().overflowed, 0U);
}

TEST(Emulator, ABurstLawThatNearlyAlwaysGoesBackToLossesLosesAsMuchAsItSays) {
  // Rounded, the way from good to bad is taken a hair more often than always.
  using Law = std::pair<const char*, const char*>;
  for (const auto& [share, burst] :
       {Law{"0.8", "4.0"}, {"0.9", "9.0"}, {"0.6666666666666667", "2.0"}, {"0.75", "3.0"}}) {
    const std::string keys =
        std::string("loss_model = \"gilbert-elliott\"\nloss = ") + share + "\nloss_burst_packets = " + burst;
    const double loss = std::stod(share);
    Emulator emulator(both(keys), {1});
    constexpr int kPackets = 20'000;
    for (int i = 0; i < kPackets; ++i) emulator.push(i * kMs, 100U, 1);
    EXPECT_NEAR(static_cast<double>(emulator.counters().lost) / kPackets, loss, 0.03) << keys;
  }
}

TEST(Emulator, OverflowIsCountedAndTheStoreStaysUsable) {
  Emulator emulator(both("delay_ms = 50"), {1}, {16, 16 * 512, 2048});
  std::mt19937 random(1);
  for (std::uint64_t round = 0; round < 100; ++round) {
    const auto now_ns = static_cast<std::int64_t>(round) * 1000 * kMs;
    for (int i = 0; i < 40; ++i) emulator.push(now_ns, random_bytes(random, 1 + random() % 2500), round);
    int delivered = 0;
    while (const auto delivery = emulator.pop(now_ns + 50 * kMs)) {
      EXPECT_EQ(delivery->tag, round);
      ++delivered;
    }
    EXPECT_GT(delivered, 3);
    EXPECT_LE(delivered, 16);
  }
  const Counters& counters = emulator.counters();
  EXPECT_GT(counters.overflowed, 0U);
  EXPECT_EQ(counters.delivered + counters.overflowed, counters.pushed);
}

}  // namespace
}  // namespace telekerf::netem
