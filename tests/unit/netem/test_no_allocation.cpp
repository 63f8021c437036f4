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

}  // namespace
}  // namespace telekerf::netem
