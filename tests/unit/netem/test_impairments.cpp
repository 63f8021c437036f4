// SPDX-License-Identifier: Apache-2.0
// Each impairment by its own law: order, reordering, TCP-like waits, bottleneck, slots, events, stages,
// switching.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "netem/core/emulator.h"

namespace telekerf::netem {
namespace {

constexpr std::int64_t kMs = 1'000'000;

DirectionProfile profile_of(const std::string& keys, const std::string& rest = "") {
  return parse_profile("[both]\n" + keys + "\n" + rest, "test").forward;
}

struct Journey {
  std::int64_t in_ns;
  PacketOutcome outcome;
};

/// Packets at 1 kHz; everything delivered is taken at its due time.
std::vector<Journey> travel(Emulator& emulator, int packets, std::int64_t from_ns = 0,
                            std::int64_t step_ns = kMs) {
  std::vector<Journey> journeys;
  for (int i = 0; i < packets; ++i) {
    const std::int64_t now_ns = from_ns + i * step_ns;
    while (emulator.pop(now_ns)) {
    }
    journeys.push_back({now_ns, emulator.push(now_ns, 100U, i)});
  }
  return journeys;
}

std::vector<Journey> travel(const DirectionProfile& profile, int packets, std::int64_t step_ns = kMs) {
  Emulator emulator(profile, {1}, {1U << 16, 0, 0});
  return travel(emulator, packets, 0, step_ns);
}

const char* const kJitter = "delay_ms = 50\njitter_ms = 10\ndistribution = \"gamma\"\nshape = 2\n";

TEST(Impairments, FifoLiftsEveryPacketOverItsPredecessor) {
  std::int64_t last_ns = 0;
  double drawn = 0;
  double delivered = 0;
  for (const Journey& j : travel(profile_of(kJitter), 20'000)) {
    EXPECT_EQ(j.outcome.due_ns, std::max(last_ns, j.in_ns + j.outcome.drawn_ns));
    last_ns = j.outcome.due_ns;
    drawn += static_cast<double>(j.outcome.drawn_ns);
    delivered += static_cast<double>(j.outcome.due_ns - j.in_ns);
  }
  EXPECT_GT(delivered, 1.1 * drawn);
}

TEST(Impairments, FreeOrderKeepsEveryDraw) {
  int overtaken = 0;
  std::int64_t last_ns = 0;
  for (const Journey& j : travel(profile_of(std::string(kJitter) + "order = \"free\""), 20'000)) {
    EXPECT_EQ(j.outcome.due_ns, j.in_ns + j.outcome.drawn_ns);
    overtaken += j.outcome.due_ns < last_ns;
    last_ns = j.outcome.due_ns;
  }
  EXPECT_GT(overtaken, 5'000);
}

TEST(Impairments, ReorderedPacketsOvertakeTheGapAndNoMore) {
  Emulator emulator(profile_of("delay_ms = 20\norder = \"reorder\"\nreorder = 0.1\nreorder_gap = 3"), {1});
  std::vector<std::uint64_t> arrived;
  std::vector<bool> chosen;
  for (int i = 0; i < 10'000; ++i) {
    while (const auto delivery = emulator.pop(i * kMs)) arrived.push_back(delivery->tag);
    chosen.push_back(emulator.push(i * kMs, 100U, i).reordered);
  }
  std::vector<std::size_t> place(arrived.size());
  for (std::size_t i = 0; i < arrived.size(); ++i) place[arrived[i]] = i;
  int checked = 0;
  for (std::size_t n = 10; n + 10 < arrived.size(); ++n) {
    int before = 0;  // in-order packets sent earlier that arrive later
    for (std::size_t m = n - 10; m < n; ++m) before += !chosen[m] && place[m] > place[n];
    EXPECT_EQ(before, chosen[n] ? 3 : 0) << n;
    checked += chosen[n];
  }
  EXPECT_NEAR(checked, 1000, 200);
}

TEST(Impairments, TcpLikeLossesBecomeHeadOfLineWaits) {
  const auto journeys =
      travel(profile_of("delay_ms = 20\nloss = 0.1\ntcp_like = true\nrto_ms = 200"), 50'000, 500 * kMs);
  int waits[8] = {};
  for (const Journey& j : journeys) {
    EXPECT_FALSE(j.outcome.lost());
    const int n = j.outcome.retransmissions;
    ++waits[n];
    // rto, rto + 2 rto, ... ; sent slowly, so that only its own wait can hold a packet up, or the one before
    // it.
    EXPECT_GE(j.outcome.due_ns - j.in_ns, (20 + 200 * ((1 << n) - 1)) * kMs);
  }
  EXPECT_NEAR(waits[1], 50'000 * 0.1 * 0.9, 6 * std::sqrt(50'000 * 0.09));
  EXPECT_NEAR(waits[2], 50'000 * 0.01 * 0.9, 6 * std::sqrt(50'000 * 0.009));
  // At 1 kHz all that follow wait as well.
  const auto dense = travel(profile_of("delay_ms = 20\nloss = 0.001\ntcp_like = true\nrto_ms = 200"), 20'000);
  std::int64_t last_ns = 0;
  int held_up = 0;
  for (const Journey& j : dense) {
    EXPECT_GE(j.outcome.due_ns, last_ns);
    held_up += j.outcome.retransmissions == 0 && j.outcome.due_ns - j.in_ns > 21 * kMs;
    last_ns = j.outcome.due_ns;
  }
  EXPECT_GT(held_up, 500);
}

TEST(Impairments, BottleneckSpacesPacketsAndDropsAtItsLimit) {
  // 100 bytes at 80 kbit/s take 10 ms; 400 bytes of queue hold 40 ms.
  const auto journeys = travel(profile_of("rate_kbit_per_s = 80\nqueue_bytes = 400"), 1000);
  std::int64_t last_ns = -10 * kMs;
  int passed = 0;
  for (const Journey& j : journeys) {
    if (j.outcome.queue_full) continue;
    EXPECT_GE(j.outcome.due_ns, last_ns + 10 * kMs);
    EXPECT_LE(j.outcome.due_ns - j.in_ns, 50 * kMs);
    last_ns = j.outcome.due_ns;
    ++passed;
  }
  EXPECT_NEAR(passed, 100 + 4, 2);
  // Offered less than the rate: the packet's own 10 ms and nothing lost.
  for (const Journey& j : travel(profile_of("rate_kbit_per_s = 80\nqueue_bytes = 400"), 1000, 11 * kMs)) {
    EXPECT_FALSE(j.outcome.queue_full);
    EXPECT_EQ(j.outcome.due_ns - j.in_ns, 10 * kMs);
  }
}

TEST(Impairments, SlotsLetPacketsOutAtTheirStartsOnly) {
  std::int64_t last_ns = -1;
  int crowd = 0;
  for (const Journey& j :
       travel(profile_of("delay_ms = 3.3\nslot_ms = 5\nslot_jitter_ms = 1\nslot_packets = 6"), 5000)) {
    EXPECT_LE(j.outcome.due_ns % (5 * kMs), kMs);
    EXPECT_GE(j.outcome.due_ns, j.in_ns + j.outcome.drawn_ns);
    EXPECT_LE(j.outcome.due_ns, j.in_ns + j.outcome.drawn_ns + 11 * kMs);
    crowd = j.outcome.due_ns == last_ns ? crowd + 1 : 1;
    EXPECT_LE(crowd, 6);
    EXPECT_GE(j.outcome.due_ns, last_ns);
    last_ns = j.outcome.due_ns;
  }
}

TEST(Impairments, EventsComeBackOnTimeWithOneDelayEach) {
  const auto journeys = travel(profile_of("delay_ms = 10\norder = \"free\"", R"(
[[event]]
first_s = 1
every_s = 2
duration_ms = 100
add_delay_ms = [20, 50]
[[event]]
first_s = 2
duration_ms = 50
loss = 1
)"),
                               20'000);
  std::set<std::int64_t> delays;
  for (const Journey& j : journeys) {
    const std::int64_t since = j.in_ns - 1000 * kMs;
    const bool inside = since >= 0 && since % (2000 * kMs) < 100 * kMs;
    const bool outage = j.in_ns >= 2000 * kMs && j.in_ns < 2050 * kMs;
    EXPECT_EQ(j.outcome.lost_by_event, outage) << j.in_ns;
    if (!inside) {
      EXPECT_EQ(j.outcome.event_ns, 0);
    } else {
      EXPECT_GE(j.outcome.event_ns, 20 * kMs);
      EXPECT_LE(j.outcome.event_ns, 50 * kMs);
      delays.insert(j.outcome.event_ns);
    }
  }
  EXPECT_EQ(delays.size(), 10U);  // 1, 3, ... 19 s
}

TEST(Impairments, StagesTakeOverAtTheirTime) {
  const auto journeys =
      travel(profile_of("delay_ms = 10", "[[stage]]\nfrom_s = 2\n[stage.both]\ndelay_ms = 30\n"), 4000);
  for (const Journey& j : journeys) EXPECT_EQ(j.outcome.drawn_ns, (j.in_ns < 2000 * kMs ? 10 : 30) * kMs);
}

TEST(Impairments, SwitchingKeepsWhatIsUnderWayAndItsOrder) {
  Emulator emulator(profile_of("delay_ms = 50"), {1});
  const auto before = travel(emulator, 100);
  CompiledProfile fresh(profile_of("delay_ms = 5\nduplicate = 1"));
  emulator.switch_to(fresh, 100 * kMs);
  const auto after = travel(emulator, 100, 100 * kMs);
  EXPECT_EQ(before.back().outcome.due_ns, (99 + 50) * kMs);
  EXPECT_EQ(after.front().outcome.due_ns, (99 + 50) * kMs);  // behind the last of the old network
  EXPECT_EQ(after.back().outcome.due_ns, (199 + 5) * kMs);
  EXPECT_TRUE(after.front().outcome.duplicated);
  std::uint64_t copies = 0;
  while (const auto delivery = emulator.pop(1000 * kMs)) copies += delivery->duplicate;
  EXPECT_GT(copies, 0U);
}

TEST(Impairments, CorruptionFlipsOneBitAndSaysSo) {
  Emulator emulator(profile_of("corrupt = 0.5\nduplicate = 0.5"), {1});
  std::vector<std::byte> packet(700, std::byte{0x5A});
  int corrupted = 0;
  std::set<int> places;
  for (int i = 0; i < 2000; ++i) {
    emulator.push(i, packet, 0);
    while (const auto delivery = emulator.pop(i)) {
      int flipped = 0;
      for (std::size_t k = 0; k < packet.size(); ++k) {
        const auto change = static_cast<unsigned>(delivery->bytes[k] ^ packet[k]);
        flipped += std::popcount(change);
        if (change != 0) places.insert(static_cast<int>(8 * k) + std::countr_zero(change));
      }
      EXPECT_EQ(flipped, delivery->corrupted ? 1 : 0);
      corrupted += delivery->corrupted;
    }
  }
  EXPECT_NEAR(corrupted, 1500, 6 * std::sqrt(750.0));
  EXPECT_GT(places.size(), 1000U);
}

TEST(Impairments, OneImpairmentDoesNotDisturbAnother) {
  const std::string base = std::string(kJitter) + "loss = 0.1\n";
  const auto plain = travel(profile_of(base), 5000);
  const auto busy = travel(profile_of(base + "duplicate = 0.3\ncorrupt = 0.2\n"), 5000);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(plain[i].outcome.drawn_ns, busy[i].outcome.drawn_ns);
    EXPECT_EQ(plain[i].outcome.lost(), busy[i].outcome.lost());
  }
}

TEST(Impairments, FlowsAreIndependent) {
  const auto profile = profile_of(std::string(kJitter) + "loss = 0.1\norder = \"free\"");
  Emulator alone(profile, {1, 5});
  Emulator one(profile, {1, 5});
  Emulator two(profile, {1, 6});
  double product = 0;
  double first_square = 0;
  double second_square = 0;
  constexpr int kPackets = 20'000;
  for (int i = 0; i < kPackets; ++i) {
    const PacketOutcome expected = alone.push(i * kMs, 10U, 0);
    const PacketOutcome a = one.push(i * kMs, 10U, 0);
    const PacketOutcome b = two.push(i * kMs, 10U, 0);  // traffic of another flow in between
    EXPECT_EQ(a.due_ns, expected.due_ns);
    EXPECT_EQ(a.lost(), expected.lost());
    const double x = static_cast<double>(a.drawn_ns) * 1e-6 - 64.1;
    const double y = static_cast<double>(b.drawn_ns) * 1e-6 - 64.1;
    product += x * y;
    first_square += x * x;
    second_square += y * y;
    for (Emulator* e : {&alone, &one, &two}) {
      while (e->pop(i * kMs)) {
      }
    }
  }
  EXPECT_NEAR(product / std::sqrt(first_square * second_square), 0.0, 6 / std::sqrt(kPackets));
}

}  // namespace
}  // namespace telekerf::netem
