// SPDX-License-Identifier: Apache-2.0
// What a station answers to whoever stops: once, again for each who asks, and nothing before its loop obeys.
#include <gtest/gtest.h>

#include <set>

#include "common/protocol/stop_talk.h"

namespace telekerf {
namespace {

StopMessage said(std::uint32_t number, bool set) {
  return {.epoch = 1, .number = number, .source = "ann", .set = set, .obeyed = false, .reason = "smoke"};
}

class Answering : public testing::Test {
 protected:
  void hear(const StopMessage& message) {
    (void)latch_.hear(message);
    answers_.asked(message);
  }
  std::size_t taken(std::uint32_t obeyed) { return answers_.take(latch_, obeyed).size(); }
  StopLatch latch_;
  StopReplies answers_{9};
};

TEST_F(Answering, SaysThatItObeysOnceAndNotBefore) {
  hear(said(5, true));
  EXPECT_EQ(taken(0), 0u) << "the loop has not acted on it";
  const auto answers = answers_.take(latch_, 5);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].epoch, 9u);
  EXPECT_EQ(answers[0].number, 5u);
  EXPECT_EQ(answers[0].source, "ann");
  EXPECT_EQ(answers[0].reason, "smoke");
  EXPECT_TRUE(answers[0].set);
  EXPECT_TRUE(answers[0].obeyed);
  EXPECT_EQ(taken(5), 0u);
}

TEST_F(Answering, SaysItAgainForEachWhoStillAsks) {
  hear(said(5, true));
  EXPECT_EQ(taken(5), 1u);
  hear(said(5, true));
  EXPECT_EQ(taken(5), 1u) << "the answer may have been lost";
  StopMessage answer = said(5, true);
  answer.obeyed = true;
  hear(answer);
  EXPECT_EQ(taken(5), 0u) << "the other station does not ask";
}

TEST_F(Answering, SaysThatItIsOverWhenTheLoopHasLetGo) {
  hear(said(5, true));
  EXPECT_EQ(taken(5), 1u);
  hear(said(5, false));
  EXPECT_EQ(taken(5), 0u) << "the loop still obeys it";
  const auto answers = answers_.take(latch_, 0);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_FALSE(answers[0].set);
  EXPECT_EQ(answers[0].number, 5u);
  EXPECT_EQ(taken(0), 0u);
  hear(said(5, false));
  EXPECT_EQ(taken(0), 1u);
}

/// The list of what is over is short, and a number may come once more after it has left.
TEST_F(Answering, ForgetsWhomItHasToldOfWhatTheLatchHasForgotten) {
  StopMessage over = said(5, false), again = said(5, true);
  over.obeyed = again.obeyed = true;  // another station's words ask for nothing
  (void)latch_.quoted(5);
  hear(again);
  EXPECT_EQ(taken(5), 1u) << "it obeys";
  hear(over);
  EXPECT_EQ(taken(0), 1u) << "it is over";
  for (std::uint32_t n = 101; n < 140; ++n) hear(said(n, false));
  (void)taken(0);
  hear(again);
  EXPECT_EQ(taken(5), 1u) << "it obeys anew";
  hear(over);
  EXPECT_EQ(taken(0), 1u) << "it is over anew";
}

TEST(StopNumbers, AreNoneThatAreEasilyMetAgain) {
  std::set<std::uint32_t> drawn;
  for (int n = 0; n < 20; ++n) drawn.insert(any_stop_number());
  EXPECT_EQ(drawn.size(), 20u) << "once in 20 million runs two are the same";
  EXPECT_FALSE(drawn.contains(0));
}

TEST_F(Answering, DoesNotNameAStopWhoseOwnerItDoesNotKnow) {
  (void)latch_.quoted(5);
  EXPECT_EQ(taken(5), 0u);
  hear(said(5, true));
  EXPECT_EQ(taken(5), 1u);
}

}  // namespace
}  // namespace telekerf
