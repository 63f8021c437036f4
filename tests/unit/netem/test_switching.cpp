// SPDX-License-Identifier: Apache-2.0
// What a change of network forgets and what it keeps; time that runs backwards; the store under it all.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "netem/core/emulator.h"

namespace telekerf::netem {
namespace {

constexpr std::int64_t kMs = 1'000'000;

DirectionProfile of(const std::string& text) { return parse_profile("[both]\n" + text, "test").forward; }

void switch_to(Emulator& emulator, const DirectionProfile& profile, std::int64_t now_ns) {
  CompiledProfile fresh(profile);
  emulator.switch_to(fresh, now_ns);
}

TEST(Switching, StagesEventsAndSlotsCountFromIt) {
  const DirectionProfile stages =
      of("delay_ms = 1\n[[stage]]\nfrom_s = 2\n[stage.both]\ndelay_ms = 3\n[[event]]\nfirst_s = "
         "1\nduration_ms = 100\n"
         "add_delay_ms = [5, 5]");
  Emulator emulator(stages, {1}, {}, 10 * kMs);
  const auto waits_ms = [&](std::int64_t now_ms) {
    const PacketOutcome outcome = emulator.push(now_ms * kMs, 10U, 0);
    return static_cast<int>((outcome.drawn_ns + outcome.event_ns) / kMs);
  };
  EXPECT_EQ(waits_ms(1009), 1);
  EXPECT_EQ(waits_ms(1010), 6);
  EXPECT_EQ(waits_ms(1109), 6);
  EXPECT_EQ(waits_ms(1110), 1);
  EXPECT_EQ(waits_ms(2009), 1);
  EXPECT_EQ(waits_ms(2010), 3);
  EXPECT_EQ(waits_ms(5000), 3);
  switch_to(emulator, stages, 5000 * kMs);
  EXPECT_EQ(waits_ms(5000), 1);
  EXPECT_EQ(waits_ms(5999), 1);
  EXPECT_EQ(waits_ms(6000), 6);
  EXPECT_EQ(waits_ms(6100), 1);
  EXPECT_EQ(waits_ms(7000), 3);
  switch_to(emulator, of("delay_ms = 1\n[[event]]\nfirst_s = 2\nduration_ms = 100\nadd_delay_ms = [7, 7]"),
            7000 * kMs);
  EXPECT_EQ(waits_ms(8500), 1);  // where the event of the network before was over
  EXPECT_EQ(waits_ms(9000), 8);
  EXPECT_EQ(waits_ms(9100), 1);
  switch_to(emulator, of("slot_ms = 10\nslot_packets = 1"), 9203 * kMs);
  EXPECT_EQ(emulator.push(9203 * kMs, 10U, 0).due_ns, 9203 * kMs);
  EXPECT_EQ(emulator.push(9203 * kMs, 10U, 0).due_ns, 9213 * kMs);
  switch_to(emulator, of("slot_ms = 10\nslot_packets = 1"), 9204 * kMs);
  EXPECT_EQ(emulator.push(9204 * kMs, 10U, 0).due_ns, 9214 * kMs)
      << "behind the last, at a slot of the new network";
}

TEST(Switching, TheLossStateTheQueueAndTheRecordingBeginAnew) {
  Emulator emulator(of("loss_model = \"gilbert-elliott\"\nge_p = 1\nge_r = 0.000001"), {1});
  std::int64_t now_ns = 0;
  const auto lost = [&] {
    int count = 0;
    for (int i = 0; i < 200; ++i) count += emulator.push(now_ns += kMs, 10U, 0).lost();
    return count;
  };
  EXPECT_EQ(lost(), 200) << "in the bad state";
  switch_to(emulator, of("loss_model = \"gilbert-elliott\"\nge_p = 0\nge_r = 0.000001\nge_k = 0.5"), now_ns);
  EXPECT_NEAR(lost(), 100, 40) << "of a network that is always in its good state";

  switch_to(emulator, of("rate_kbit_per_s = 8\nqueue_bytes = 2000"), now_ns);
  EXPECT_EQ(emulator.push(now_ns, 500U, 0).queued_ns, 500 * kMs);
  EXPECT_EQ(emulator.push(now_ns, 500U, 0).queued_ns, 1000 * kMs);
  switch_to(emulator, of("rate_kbit_per_s = 80\nqueue_bytes = 2000"), now_ns);
  EXPECT_EQ(emulator.push(now_ns, 500U, 0).queued_ns, 150 * kMs) << "behind what waits, at the new rate";

  DirectionProfile recorded;
  recorded.trace_end = TraceEnd::kRepeat;
  recorded.recording = std::make_shared<Recording>(
      Recording{{0, 1 * kMs}, {10 * kMs, 2 * kMs}, {20 * kMs, 0, true}, {30 * kMs, 3 * kMs}});
  for (int round = 0; round < 2; ++round) {
    now_ns += 5000 * kMs;
    switch_to(emulator, recorded, now_ns);
    for (int i = 0; i < 9; ++i) {
      const std::int64_t at_ns = now_ns + i * 10 * kMs;
      const PacketOutcome outcome = emulator.push(at_ns, 10U, 0);
      EXPECT_EQ(outcome.lost(), i % 4 == 2);
      if (!outcome.lost()) {
        EXPECT_EQ(outcome.due_ns - at_ns, (i % 4 == 3 ? 3 : i % 4 + 1) * kMs) << i;
      }
    }
    now_ns += 85 * kMs;
  }
  recorded.loss_only = true;
  recorded.stages[0].conditions.loss.model = LossModel::kTrace;
  switch_to(emulator, recorded, now_ns);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(emulator.push(now_ns + i * 10 * kMs, 10U, 0).lost(), i % 4 == 2) << i;
}

TEST(Emulator, TimeDoesNotRunBackwards) {
  Emulator emulator(of("delay_ms = 3\norder = \"free\""), {1});
  EXPECT_EQ(emulator.push(10 * kMs, 10U, 0).due_ns, 13 * kMs);
  EXPECT_EQ(emulator.push(5 * kMs, 10U, 0).due_ns, 13 * kMs);
  EXPECT_EQ(emulator.push(11 * kMs, 10U, 0).due_ns, 14 * kMs);
}

TEST(Emulator, ALossThatIsLostAgainGetsThroughAtTheSixthAttempt) {
  Emulator emulator(of("delay_ms = 3\nloss = 1\ntcp_like = true\nrto_ms = 100"), {1});
  const PacketOutcome outcome = emulator.push(0, 10U, 0);
  EXPECT_EQ(outcome.retransmissions, 6);
  EXPECT_EQ(outcome.due_ns, (3 + 63 * 100) * kMs);
  // An outage ends: the attempts within it are lost, the first one after it is not.
  Emulator outage(of("tcp_like = true\nrto_ms = 100\n[[event]]\nduration_ms = 650\nloss = 1"), {1});
  EXPECT_EQ(outage.push(0, 10U, 0).due_ns, 700 * kMs);
  EXPECT_EQ(outage.push(649 * kMs, 10U, 0).retransmissions, 1);
  EXPECT_EQ(outage.push(650 * kMs, 10U, 0).retransmissions, 0);
  EXPECT_EQ(outage.counters().lost, 0U);
}

TEST(Emulator, OnlyWhatIsStillUnderWayIsOvertaken) {
  Emulator emulator(of("delay_ms = 20\norder = \"reorder\"\nreorder = 1\nreorder_gap = 2"), {1});
  EXPECT_FALSE(emulator.push(0, 10U, 0).reordered);
  const PacketOutcome arrived = emulator.push(20 * kMs, 10U, 1);
  EXPECT_FALSE(arrived.reordered) << "the one before arrives just now";
  EXPECT_EQ(arrived.due_ns, 40 * kMs);
  const PacketOutcome chosen = emulator.push(39 * kMs, 10U, 2);
  EXPECT_TRUE(chosen.reordered);
  EXPECT_EQ(chosen.due_ns, 40 * kMs - 1);
  EXPECT_EQ(emulator.counters().reordered, 1U);
}

TEST(Emulator, AnIdleBottleneckTakesAPacketLargerThanItsQueue) {
  Emulator emulator(of("rate_kbit_per_s = 80\nqueue_bytes = 200"), {1});
  EXPECT_FALSE(emulator.push(0, 1000U, 0).queue_full);
  EXPECT_TRUE(emulator.push(0, 100U, 0).queue_full) << "a hundred milliseconds are waiting";
  EXPECT_FALSE(emulator.push(90 * kMs, 100U, 0).queue_full) << "10 ms of the first and its own: just 20";
  EXPECT_TRUE(emulator.push(90 * kMs, 1U, 0).queue_full);
  EXPECT_EQ(emulator.counters().queue_full, 2U);
  EXPECT_EQ(emulator.counters().lost, 0U);
}

TEST(InFlight, LeavesByDueTimeAndThenAsItCame) {
  std::mt19937 random(2);
  InFlight flight({200, 0, 0});
  std::multimap<std::int64_t, std::uint64_t> expected;  // keeps the order of equal ones
  std::uint64_t tag = 0;
  for (int round = 0; round < 20'000; ++round) {
    const bool room = expected.size() < 200;
    if (random() % 2 == 0) {
      const auto due_ns = static_cast<std::int64_t>(random() % 40);
      EXPECT_EQ(flight.insert(due_ns, {.tag = tag}, {}, -1), room);
      if (room) expected.emplace(due_ns, tag);
      ++tag;
    } else if (!expected.empty()) {
      EXPECT_EQ(flight.next_due(), expected.begin()->first);
      Delivery delivery;
      flight.take(delivery);
      ASSERT_EQ(delivery.tag, expected.begin()->second) << round;
      EXPECT_EQ(delivery.due_ns, expected.begin()->first);
      expected.erase(expected.begin());
    }
    ASSERT_EQ(flight.empty(), expected.empty());
  }
}

TEST(InFlight, HoldsExactlyWhatItsCapacitySays) {
  const std::vector<std::byte> bytes(5000);
  const auto inserted = [&](InFlight& flight, std::size_t size) {
    return flight.insert(0, {.size = static_cast<std::uint32_t>(size)}, std::span(bytes).first(size), -1);
  };
  InFlight few({3, 1U << 16, 2048});
  EXPECT_TRUE(inserted(few, 2048));
  EXPECT_FALSE(inserted(few, 2049)) << "larger than the largest";
  EXPECT_TRUE(inserted(few, 1));
  EXPECT_TRUE(inserted(few, 0));
  EXPECT_FALSE(inserted(few, 0)) << "a fourth";
  InFlight small({100, 1000, 4096});  // rounded up to two chunks of 512
  EXPECT_FALSE(inserted(small, 1025));
  EXPECT_TRUE(inserted(small, 1024));
  EXPECT_FALSE(inserted(small, 1));
  Delivery delivery;
  small.take(delivery);
  EXPECT_EQ(delivery.bytes.size(), 1024u);
  for (int i = 0; i < 50; ++i) {  // the room comes back
    EXPECT_TRUE(inserted(small, 512));
    EXPECT_TRUE(inserted(small, 1));
    EXPECT_FALSE(inserted(small, 1));
    small.take(delivery);
    EXPECT_EQ(delivery.bytes.size(), 512u);
    small.take(delivery);
    EXPECT_EQ(delivery.bytes.size(), 1u);
  }
}

TEST(InFlight, FlipsTheBitThatIsAskedFor) {
  const std::vector<std::byte> bytes(1300, std::byte{0});
  for (const std::int64_t bit : {0, 7, 8, 4095, 4096, 8191, 8192, 10'399}) {
    InFlight flight({1, 2048, 2048});
    ASSERT_TRUE(flight.insert(0, {.size = 1300, .corrupted = true}, bytes, bit));
    Delivery delivery;
    flight.take(delivery);
    EXPECT_TRUE(delivery.corrupted);
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      const int expected = k == static_cast<std::size_t>(bit / 8) ? 1 << (bit % 8) : 0;
      ASSERT_EQ(std::to_integer<int>(delivery.bytes[k]), expected) << bit << " at " << k;
    }
  }
}

}  // namespace
}  // namespace telekerf::netem
