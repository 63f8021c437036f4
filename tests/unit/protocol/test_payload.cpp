// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/payload.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <numeric>

namespace telekerf {
namespace {

Payload counted(std::uint16_t size) {
  Payload payload;
  payload.size = size;
  std::iota(payload.bytes.begin(), payload.bytes.begin() + size, std::uint8_t{1});
  return payload;
}

TEST(Payload, ACopyHoldsTheSameOctets) {
  for (const std::uint16_t size : std::initializer_list<std::uint16_t>{0, 1, 60, 2048}) {
    const Payload original = counted(size);
    const Payload constructed(original);
    Payload assigned = counted(7);
    assigned = original;
    for (const Payload* copy : std::initializer_list<const Payload*>{&constructed, &assigned}) {
      EXPECT_EQ(copy->size, size);
      EXPECT_TRUE(std::equal(copy->view().begin(), copy->view().end(), original.view().begin(),
                             original.view().end()));
    }
  }
}

TEST(Payload, ACopyMovesOnlyWhatCounts) {
  Payload target = counted(100);
  target = counted(10);
  EXPECT_EQ(target.bytes[9], 10);
  EXPECT_EQ(target.bytes[10], 11) << "as it was: octets beyond the size are nobody's";
}

TEST(Payload, ASizeBeyondTheRoomIsNeverFollowed) {
  Payload broken = counted(2048);
  broken.size = 60'000;
  const Payload copy(broken);
  EXPECT_EQ(copy.size, 60'000) << "a writer refuses it";
  EXPECT_EQ(copy.view().size(), Payload::kCapacity);
}

}  // namespace
}  // namespace telekerf
