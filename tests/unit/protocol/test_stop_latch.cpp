// SPDX-License-Identifier: Apache-2.0
// Stops in any order, any number of times: in force until their owner ends them.
#include "common/protocol/stop_latch.h"

#include <gtest/gtest.h>

#include <array>
#include <iterator>
#include <map>
#include <random>
#include <string>

namespace telekerf {
namespace {

using Heard = StopLatch::Heard;

StopMessage message(std::uint32_t number, bool set, const std::string& source = "operator") {
  StopMessage message;
  message.number = number;
  message.set = set;
  message.source = source;
  message.reason = "smoke";
  return message;
}

TEST(StopLatch, AStopHoldsUntilItsOwnerEndsIt) {
  StopLatch latch;
  EXPECT_EQ(latch.order().number, 0u);
  EXPECT_EQ(latch.hear(message(5, true)), Heard::kStopped);
  EXPECT_EQ(latch.hear(message(5, true)), Heard::kKnown);
  EXPECT_EQ(latch.order().number, 5u);
  EXPECT_EQ(latch.hear(message(5, false, "somebody")), Heard::kRefused);
  EXPECT_EQ(latch.hear(message(6, false)), Heard::kKnown) << "another one's number";
  EXPECT_EQ(latch.order().number, 5u);
  EXPECT_EQ(latch.hear(message(5, false)), Heard::kCleared);
  EXPECT_EQ(latch.order().number, 0u);
  EXPECT_EQ(latch.order().cleared.front(), 5u);
  EXPECT_EQ(latch.hear(message(5, true)), Heard::kKnown) << "said again on its way: it is over";
  EXPECT_EQ(latch.order().number, 0u);
  EXPECT_EQ(latch.hear(message(0, true)), Heard::kKnown) << "no stop has this number";
}

TEST(StopLatch, AMessageThatSaysNothingStopsNothing) {
  StopLatch latch;
  EXPECT_EQ(latch.hear({}), Heard::kKnown);
  EXPECT_TRUE(latch.in_force().empty());
}

TEST(StopLatch, ItsOrderNamesTheFourThatWereClearedLastNewestFirst) {
  StopLatch latch;
  using Numbers = std::array<std::uint32_t, 4>;
  EXPECT_EQ(latch.order().cleared, (Numbers{}));
  for (std::uint32_t n = 11; n <= 12; ++n) (void)latch.hear(message(n, false));
  EXPECT_EQ(latch.order().cleared, (Numbers{12, 11, 0, 0}));
  for (std::uint32_t n = 13; n <= 40; ++n) (void)latch.hear(message(n, false));
  EXPECT_EQ(latch.order().cleared, (Numbers{40, 39, 38, 37}));
}

TEST(StopLatch, SeveralStopsAreSeveral) {
  StopLatch latch;
  (void)latch.hear(message(5, true, "a"));
  (void)latch.hear(message(9, true, "b"));
  EXPECT_EQ(latch.hear(message(5, false, "a")), Heard::kCleared);
  EXPECT_EQ(latch.order().number, 9u);
  EXPECT_EQ(latch.hear(message(9, false, "a")), Heard::kRefused);
  EXPECT_EQ(latch.hear(message(9, false, "b")), Heard::kCleared);
  EXPECT_EQ(latch.order().number, 0u);
}

TEST(StopLatch, AQuotedNumberStopsAndLearnsItsOwnerLater) {
  StopLatch latch;
  EXPECT_EQ(latch.quoted(0), Heard::kKnown);
  EXPECT_EQ(latch.quoted(5), Heard::kStopped);
  EXPECT_EQ(latch.hear(message(5, true, "a")), Heard::kKnown);
  EXPECT_EQ(latch.hear(message(5, false, "b")), Heard::kRefused);
  EXPECT_EQ(latch.hear(message(5, false, "a")), Heard::kCleared);
  EXPECT_EQ(latch.quoted(5), Heard::kKnown) << "the other side has not heard of its end yet";
}

TEST(StopLatch, WhoseOwnerIsNotKnownYetIsEndedByNobodyButAStationThatKnewIt) {
  StopLatch latch;
  (void)latch.quoted(5);
  EXPECT_EQ(latch.hear(message(5, false, "b")), Heard::kRefused);
  EXPECT_EQ(latch.hear(message(5, false, "")), Heard::kRefused);
  EXPECT_EQ(latch.order().number, 5u);
  StopMessage over = message(5, false, "a");
  over.obeyed = true;
  EXPECT_EQ(latch.hear(over), Heard::kCleared);
  EXPECT_EQ(latch.order().number, 0u);
}

TEST(StopLatch, AnEndThatOvertakesItsStopCounts) {
  StopLatch latch;
  EXPECT_EQ(latch.hear(message(5, false)), Heard::kKnown);
  EXPECT_EQ(latch.hear(message(5, true)), Heard::kKnown);
  EXPECT_EQ(latch.order().number, 0u);
  EXPECT_EQ(latch.hear(message(7, false, "")), Heard::kRefused) << "nobody says so";
}

TEST(StopLatch, AnEndThatIsSaidAgainAndAgainCrowdsOutNoOther) {
  StopLatch latch;
  (void)latch.hear(message(5, false));
  for (int n = 0; n < 20; ++n) EXPECT_EQ(latch.hear(message(6, false)), Heard::kKnown);
  EXPECT_EQ(latch.cleared().size(), 2u);
  EXPECT_EQ(latch.hear(message(5, true)), Heard::kKnown) << "still known to be over";
}

TEST(StopLatch, AFloodChangesNothing) {
  StopLatch latch;
  for (std::uint32_t n = 1; n < 1000; ++n) (void)latch.hear(message(n, true));
  EXPECT_NE(latch.order().number, 0u);
  EXPECT_LE(latch.in_force().size(), 16u);
  for (std::uint32_t n = 1; n < 1000; ++n) (void)latch.hear(message(n, false));
  EXPECT_EQ(latch.order().number, 0u);
  EXPECT_LE(latch.cleared().size(), 16u);
}

/// A latch and what is to come of it by the words of the contract alone, under any messages in any order.
TEST(StopLatch, WhateverIsSaidOnlyWhoSaidAStopEndsItAndTextKeepsIt) {
  std::mt19937_64 random(17);
  const std::string sources[] = {"", "ann", "bob", "two\nlines\tof"};
  const std::uint32_t numbers[] = {0, 1, 2, 3, 4, 0x7FFFFFFF, 0xFFFFFFFF};
  int stopped = 0, cleared = 0;
  for (int trial = 0; trial < 300; ++trial) {
    StopLatch latch;
    std::map<std::uint32_t, std::string> in_force;  // by number: its owner
    for (int n = 0; n < 200; ++n) {
      StopMessage said = message(numbers[random() % std::size(numbers)], random() % 3 != 0,
                                 sources[random() % std::size(sources)]);
      said.obeyed = random() % 2 == 0;
      const bool quoted = random() % 4 == 0;
      const auto held = in_force.find(said.number);
      const Heard heard = quoted ? latch.quoted(said.number) : latch.hear(said);
      const std::string source = quoted ? "" : said.source;
      if (heard == Heard::kStopped) {
        ASSERT_TRUE((quoted || said.set) && held == in_force.end());
        in_force[said.number] = source;
        ++stopped;
      } else if (held != in_force.end() && held->second.empty() && (quoted || said.set)) {
        held->second = source;
      } else if (heard == Heard::kCleared) {
        ASSERT_TRUE(held != in_force.end() && !quoted && !said.set);
        ASSERT_TRUE(held->second.empty() ? said.obeyed : held->second == said.source);
        in_force.erase(held);
        ++cleared;
      }
      ASSERT_EQ(latch.in_force().size(), in_force.size());
      for (const StopLatch::Entry& entry : latch.in_force()) ASSERT_TRUE(in_force.contains(entry.number));
      ASSERT_EQ(latch.order().number != 0, !in_force.empty());
      ASSERT_TRUE(in_force.empty() || in_force.contains(latch.order().number));
      const StopLatch back = StopLatch::from_text(latch.text());
      ASSERT_EQ(back.in_force().size(), in_force.size());
      ASSERT_EQ(back.text(), latch.text());
    }
  }
  EXPECT_GT(stopped, 1000);
  EXPECT_GT(cleared, 300);
}

TEST(StopLatch, AnyBytesAsItsFileAreStopsOrNone) {
  std::mt19937_64 random(18);
  const std::string letters = "0123456789\t\t\n\nab\r\0-.";
  std::size_t kept = 0;
  for (int n = 0; n < 20'000; ++n) {
    std::string text(random() % 60, ' ');
    for (char& c : text) c = n % 2 == 0 ? static_cast<char>(random()) : letters[random() % letters.size()];
    const StopLatch latch = StopLatch::from_text(text);
    kept += latch.in_force().size();
    for (const StopLatch::Entry& entry : latch.in_force()) ASSERT_NE(entry.number, 0u);
    ASSERT_EQ(StopLatch::from_text(latch.text()).in_force().size(), latch.in_force().size());
  }
  EXPECT_GT(kept, 1000u);
}

TEST(StopLatch, ItSurvivesAsText) {
  StopLatch latch;
  (void)latch.hear(message(4294967295, true, "a b"));
  (void)latch.hear(message(7, true, "c"));
  StopLatch again = StopLatch::from_text(
      "nonsense\n\tx\ty\n0\tx\ty\n4294967296\tx\ty\n9999999999\tx\ty\n99999999999\tx\ty\n99999999999999999999"
      "999\tx\ty\n00000000001\tx\ty\n" +
      latch.text());
  ASSERT_EQ(again.in_force().size(), 2u);
  EXPECT_EQ(again.in_force()[0].source, "a b");
  EXPECT_EQ(again.in_force()[0].reason, "smoke");
  EXPECT_EQ(again.order().number, 7u);
  EXPECT_EQ(again.hear(message(4294967295, false, "a b")), Heard::kCleared);
  EXPECT_EQ(StopLatch().text(), "");
}

TEST(StopLatch, AReasonOfSeveralLinesIsOneInItsText) {
  StopLatch latch;
  StopMessage said = message(7, true);
  said.reason = "a\nb\rc\td";
  (void)latch.hear(said);
  const StopLatch again = StopLatch::from_text(latch.text());
  ASSERT_EQ(again.in_force().size(), 1u);
  EXPECT_EQ(again.in_force()[0].reason, "a b c d");
}

TEST(StopOrder, WhatTheOtherSideQuotesHoldsUnlessItIsOver) {
  EXPECT_EQ(StopOrder{}.in_force(0), 0u);
  EXPECT_EQ((StopOrder{0, {0}}).in_force(0), 0u);
  EXPECT_EQ((StopOrder{5, {0}}).in_force(0), 5u);
  EXPECT_EQ((StopOrder{5, {0}}).in_force(6), 5u);
  EXPECT_EQ((StopOrder{0, {0}}).in_force(6), 6u);
  EXPECT_EQ((StopOrder{0, {6}}).in_force(6), 0u);
  EXPECT_EQ((StopOrder{0, {5}}).in_force(6), 6u);
}

}  // namespace
}  // namespace telekerf
