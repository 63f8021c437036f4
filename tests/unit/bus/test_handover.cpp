// SPDX-License-Identifier: Apache-2.0
#include "common/bus/handover.h"

#include <gtest/gtest.h>

#include <thread>

namespace telekerf {
namespace {

/// Counts those that live, and shows when it is used after its end.
class Counted {
 public:
  explicit Counted(int number) : number_(number) { ++living; }
  ~Counted() {
    --living;
    number_ = kGone;
  }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  int number() const { return number_; }

  static constexpr int kGone = -1;
  static inline std::atomic<int> living{0};

 private:
  std::atomic<int> number_;
};

TEST(Handover, NothingBeforeTheFirst) {
  Handover<Counted> handover;
  EXPECT_EQ(handover.current(), nullptr);
}

TEST(Handover, TheNewestIsTakenAndWhatItOvertookIsFreed) {
  Handover<Counted> handover;
  for (int i = 0; i < 5; ++i) handover.offer(std::make_unique<Counted>(i));
  EXPECT_EQ(Counted::living, 1);
  ASSERT_NE(handover.current(), nullptr);
  EXPECT_EQ(handover.current()->number(), 4);
  EXPECT_EQ(handover.current(), handover.current());
}

TEST(Handover, TheOneBeforeOutlivesTheStepThatGetsAnother) {
  Handover<Counted> handover;
  handover.offer(std::make_unique<Counted>(1));
  const Counted* const before = handover.current();
  handover.offer(std::make_unique<Counted>(2));
  handover.collect();
  EXPECT_EQ(before->number(), 1) << "not taken yet";
  EXPECT_EQ(handover.current()->number(), 2);
  handover.collect();
  EXPECT_EQ(before->number(), 1) << "the step that got another may still look at it";
  (void)handover.current();
  EXPECT_EQ(Counted::living, 2) << "freed by the giver alone";
  handover.collect();
  EXPECT_EQ(Counted::living, 1);
}

TEST(Handover, ALoopThatIsFasterThanTheGiverGoesOnWithWhatItHas) {
  Handover<Counted> handover;
  for (int i = 0; i < 3; ++i) {
    handover.offer(std::make_unique<Counted>(i));
    for (int step = 0; step < 3; ++step) EXPECT_EQ(handover.current()->number(), i);
  }
  EXPECT_LE(Counted::living, 3);
}

TEST(Handover, NothingIsLeftBehind) {
  {
    Handover<Counted> handover;
    handover.offer(std::make_unique<Counted>(1));
    (void)handover.current();
    handover.offer(std::make_unique<Counted>(2));
    (void)handover.current();
    handover.offer(std::make_unique<Counted>(3));
  }
  EXPECT_EQ(Counted::living, 0);
}

TEST(Handover, ThousandsGoFromThreadToThreadAndFewLive) {
  constexpr int kOffers = 20'000;
  Handover<Counted> handover;
  std::atomic<bool> done{false};
  int most = 0;
  std::jthread giver([&] {
    for (int i = 1; i <= kOffers; ++i) {
      handover.offer(std::make_unique<Counted>(i));
      most = std::max(most, Counted::living.load());
    }
    done = true;
  });
  int newest = 0;
  const Counted* last = nullptr;
  while (newest < kOffers) {
    const bool end = done;
    const Counted* const now = handover.current();
    if (last != nullptr) {
      ASSERT_NE(last->number(), Counted::kGone);
    }
    if (now != nullptr) {
      ASSERT_GE(now->number(), newest);
      newest = now->number();
    }
    if (end && newest < kOffers) {
      if (giver.joinable()) giver.join();  // the last offer waits until what came before has been collected
      handover.collect();
    }
    last = now;
  }
  EXPECT_LE(most, 4);
}

}  // namespace
}  // namespace telekerf
