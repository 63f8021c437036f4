// SPDX-License-Identifier: Apache-2.0
// After construction the packet path never touches the heap, whatever the network does to the packets.
#include <gtest/gtest.h>

#include <vector>

#include "netem/core/emulator.h"
#include "tests/unit/allocations.h"

namespace telekerf::netem {
namespace {

TEST(Emulator, AllocatesNothingAfterConstruction) {
  for (const char* name : {"hostile", "leo", "thesis-tcp"}) {
    Emulator emulator(load_profile(name).forward, {3}, {64, 64 * 512, 4096});
    CompiledProfile other(load_profile("wifi").forward);
    const std::vector<std::byte> packet(3000);
    const auto before = telekerf::testing::allocations();
    for (int i = 0; i < 20'000; ++i) {
      const std::int64_t now_ns = i * std::int64_t{1'000'000};
      while (emulator.pop(now_ns)) {
      }
      emulator.push(now_ns, std::span(packet).first(1 + i % 3000), i);
      if (i % 5000 == 0) emulator.switch_to(other, now_ns);
    }
    EXPECT_EQ(telekerf::testing::allocations() - before, 0U) << name;
    EXPECT_GT(emulator.counters().overflowed, 0U);  // the full store was met as well
  }
}

/// A queue that another bottleneck takes over, and a recording that begins anew.
TEST(Emulator, AllocatesNothingWhenAQueueIsReTimedOrARecordingRepeats) {
  const DirectionProfile slow =
      parse_profile("[both]\nrate_kbit_per_s = 80\nqueue_bytes = 20000\norder = \"free\"", "test").forward;
  DirectionProfile recorded;
  recorded.trace_end = TraceEnd::kRepeat;
  recorded.recording = std::make_shared<Recording>(Recording{{0, 30'000'000}, {7'000'000, 2'000'000}});
  Emulator emulator(slow, {3}, {256, 0, 0});
  CompiledProfile other(parse_profile("[both]\nrate_kbit_per_s = 800\nqueue_bytes = 20000", "test").forward);
  CompiledProfile third(recorded);
  const auto before = telekerf::testing::allocations();
  for (int i = 0; i < 5'000; ++i) {
    const std::int64_t now_ns = i * std::int64_t{1'000'000};
    while (emulator.pop(now_ns)) {
    }
    emulator.push(now_ns, 300U, 0);
    if (i % 100 == 50) emulator.switch_to(other, now_ns);
    if (i % 300 == 99) emulator.switch_to(third, now_ns);
  }
  EXPECT_EQ(telekerf::testing::allocations() - before, 0U);
  EXPECT_GT(emulator.counters().queue_full, 0U);
}

}  // namespace
}  // namespace telekerf::netem
