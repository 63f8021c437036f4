// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/bus/presence.h"

namespace telekerf {
namespace {

using testing::HasSubstr;

Neighbour process(const std::string& role, const std::string& name, std::uint32_t epoch = 1,
                  bool joined = true) {
  Neighbour neighbour;
  neighbour.presence = {.contract = 1,
                        .cell = "cell-1",
                        .role = role,
                        .name = name,
                        .epoch = epoch,
                        .joined = joined,
                        .version = "0"};
  return neighbour;
}

TEST(Presence, OneMasterACell) {
  const auto reason = incompatibility(process("master", "m2").presence, process("master", "m1").presence);
  ASSERT_TRUE(reason);
  EXPECT_THAT(*reason, HasSubstr("a second master in cell 'cell-1': 'm1'"));
  EXPECT_THAT(*reason, HasSubstr("--cell"));
}

TEST(Presence, ManyConsolesOfDifferentNames) {
  EXPECT_FALSE(incompatibility(process("console", "c1").presence, process("console", "c2").presence));
  EXPECT_THAT(incompatibility(process("console", "c1").presence, process("console", "c1").presence).value(),
              HasSubstr("--name"));
}

TEST(Presence, ForeignContractNamesBothAndTheRemedy) {
  auto newer = process("slave", "s").presence;
  newer.contract = 2;
  EXPECT_THAT(incompatibility(process("master", "m").presence, newer).value(),
              HasSubstr("install the same version"));
}

TEST(Presence, CellsDoNotMeet) {
  auto elsewhere = process("master", "m").presence;
  elsewhere.cell = "cell-2";
  elsewhere.contract = 9;
  EXPECT_FALSE(incompatibility(process("master", "m").presence, elsewhere));
}

TEST(Presence, WhoHasJoinedStays) {
  const auto running = process("master", "a", 9, true);
  const auto knocking = process("master", "b", 1, false);
  EXPECT_FALSE(must_give_way(running, knocking));
  EXPECT_TRUE(must_give_way(knocking, running));
}

TEST(Presence, OneSlaveAndOneVisionACellButDifferentRolesGoTogether) {
  for (const char* role : {"slave", "vision"})
    EXPECT_THAT(incompatibility(process(role, "a").presence, process(role, "b").presence).value(),
                HasSubstr(std::string("a second ") + role));
  EXPECT_FALSE(incompatibility(process("slave", "a").presence, process("master", "b").presence));
  EXPECT_THAT(incompatibility(process("slave", "a").presence, process("master", "a").presence).value(),
              HasSubstr("the name 'a' is taken in cell 'cell-1' by a master"));
}

TEST(Presence, TheLowerEpochStaysAndOfEqualOnesTheLowerKey) {
  auto lower = process("master", "a", 2, false);
  auto higher = process("master", "b", 3, false);
  lower.key[0] = 9;
  EXPECT_FALSE(must_give_way(lower, higher));
  EXPECT_TRUE(must_give_way(higher, lower));
  higher.presence.epoch = 2;
  EXPECT_TRUE(must_give_way(lower, higher)) << "its key is the higher one";
  EXPECT_FALSE(must_give_way(higher, lower));
  EXPECT_FALSE(must_give_way(lower, lower)) << "not to itself";
}

TEST(Presence, OfTwoThatStartTogetherExactlyOneGivesWay) {
  for (const std::uint32_t other_epoch : {1u, 2u, 3u}) {
    auto a = process("master", "a", 2, false);
    auto b = process("master", "b", other_epoch, false);
    a.key[5] = 1;
    EXPECT_NE(must_give_way(a, b), must_give_way(b, a)) << other_epoch;
  }
}

TEST(Presence, OfTwoThatHaveBothJoinedExactlyOneComesSecond) {
  Neighbour low = process("master", "a"), high = process("master", "b");
  low.presence.epoch = 1;
  high.presence.epoch = 2;
  low.presence.joined = high.presence.joined = true;
  EXPECT_FALSE(comes_second(low, high));
  EXPECT_TRUE(comes_second(high, low));
  high.presence.epoch = 1;
  high.key[3] = 1;
  EXPECT_TRUE(comes_second(high, low));
}

}  // namespace
}  // namespace telekerf
