// SPDX-License-Identifier: Apache-2.0
// Stops in any order, any number of times: in force until their owner ends them.
#include "common/protocol/stop_latch.h"

#include <gtest/gtest.h>

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

TEST(StopLatch, ItSurvivesAsText) {
  StopLatch latch;
  (void)latch.hear(message(4294967295, true, "a b"));
  (void)latch.hear(message(7, true, "c"));
  StopLatch again = StopLatch::from_text(
      "nonsense\n\tx\ty\n0\tx\ty\n99999999999\tx\ty\n99999999999999999999999\tx\ty\n" + latch.text());
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
  EXPECT_EQ((StopOrder{0, {0}}).in_force(0), 0u);
  EXPECT_EQ((StopOrder{5, {0}}).in_force(0), 5u);
  EXPECT_EQ((StopOrder{5, {0}}).in_force(6), 5u);
  EXPECT_EQ((StopOrder{0, {0}}).in_force(6), 6u);
  EXPECT_EQ((StopOrder{0, {6}}).in_force(6), 0u);
  EXPECT_EQ((StopOrder{0, {5}}).in_force(6), 6u);
}

}  // namespace
}  // namespace telekerf
