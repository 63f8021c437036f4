// SPDX-License-Identifier: Apache-2.0
#include "common/bus/contour_subscriber.h"

#include <gtest/gtest.h>

#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"

namespace telekerf {
namespace {

struct Prepared {
  explicit Prepared(std::uint32_t contour, double with) : id(contour), scale(with) { ++living; }
  ~Prepared() { --living; }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
  std::uint32_t id;
  double scale;
  static inline std::atomic<int> living{0};
};

class Contours : public testing::Test {
 protected:
  /// The `number`-th of any contours; its id.
  std::uint32_t publish(std::uint32_t number, std::uint32_t wrong = 0) {
    samples::Random random(number);
    ContourMessage contour = samples::contour(random, 20);
    contour.id = digest_of(contour) + wrong;
    EXPECT_TRUE(writer.write(contour));
    return contour.id;
  }
  /// As telekerf-ctl says it.
  void take(std::uint32_t id) {
    EventMessage event;
    event.kind = EventMessage::Kind::kTakeContour;
    event.value = id;
    EXPECT_TRUE(events.wait_for_reader(kPatience));
    EXPECT_TRUE(events.write(event));
  }
  /// Said until it is taken: it may not have come yet.
  bool takes(std::uint32_t id) {
    return soon([&] {
      take(id);
      std::this_thread::sleep_for(20ms);
      const Prepared* const now = subscriber.current();
      return now != nullptr && now->id == id;
    });
  }
  bool sees(std::uint32_t id) {
    return soon([&] {
      const Prepared* const now = subscriber.current();
      return now != nullptr && now->id == id;
    });
  }

  Bus vision{settings("vision", Site::kSlave)};
  Bus slave{settings("slave", Site::kSlave)};
  Writer<ContourMessage> writer{vision};
  Writer<EventMessage> events{vision};
  std::atomic<double> scale{1.0};
  std::atomic<bool> too_large{false};
  ContourSubscriber<Prepared> subscriber{slave, [&](const ContourMessage& contour) {
                                           if (too_large) throw input_error("too large");
                                           return std::make_unique<Prepared>(contour.id, scale);
                                         }};
};

TEST_F(Contours, ManyComeAndFewStay) {
  EXPECT_EQ(subscriber.current(), nullptr);
  for (std::uint32_t number = 1; number <= 10; ++number) {
    const std::uint32_t id = publish(number);
    ASSERT_TRUE(number == 1 ? sees(id) : takes(id));
    EXPECT_EQ(subscriber.message().id, id);
  }
  EXPECT_TRUE(soon([&] {
    (void)subscriber.current();
    return Prepared::living == 1;
  }));
}

TEST_F(Contours, OneThatTheOtherSideRefusesIsGivenBackForTheOneBefore) {
  Bus master{settings("master", Site::kOperator)};
  EventAnswers answers(master);
  constexpr std::uint32_t kAsker = 0;  // as take() says it
  const std::uint32_t first = publish(1);
  ASSERT_TRUE(sees(first));
  const std::uint32_t second = publish(2);
  ASSERT_TRUE(takes(second));
  const auto says = [&](std::uint32_t asker, const std::string& refusal) {
    answers.give(asker, refusal);
    std::this_thread::sleep_for(300ms);
    answers.again();
    std::this_thread::sleep_for(300ms);
    return subscriber.current()->id;
  };
  const std::string why = fmt::format("contour {} (heart, 98.8 mm long) refused: too large", second);
  EXPECT_EQ(says(kAsker + 1, why), second) << "to somebody else";
  EXPECT_EQ(says(kAsker, ""), second) << "it is done";
  EXPECT_EQ(says(kAsker, fmt::format("contour {} (heart) refused: too large", first)), second)
      << "another one";
  EXPECT_EQ(says(kAsker, "beta = 0: must be positive"), second) << "of another wish";
  EXPECT_EQ(subscriber.unfit(), 0u);
  EXPECT_EQ(says(kAsker, why), first);
  EXPECT_EQ(subscriber.message().id, first);
  EXPECT_EQ(subscriber.unfit(), 1u);
  EXPECT_EQ(says(kAsker, why), first) << "once";
  // One that is not there is no more taken than one that does not fit.
  const std::uint32_t third = publish(3);
  ASSERT_TRUE(takes(third));
  EXPECT_EQ(says(kAsker, fmt::format("no contour {} waits here", third)), first);
}

TEST(RefusesContour, OnlyWhatAnotherProcessSaysOfThisVeryContour) {
  const auto refuses = [](const std::string& text, double value = 1.0) {
    return refuses_contour({.kind = EventMessage::Kind::kAnswer, .value = value, .text = text}, "slave", 12);
  };
  EXPECT_TRUE(refuses("master: contour 12 (heart) refused: too large"));
  EXPECT_TRUE(refuses("master: no contour 12 waits here, but contour 13 (heart)"));
  EXPECT_FALSE(refuses("master: contour 12 (heart) refused: too large", 0.0));
  EXPECT_FALSE(refuses("slave: contour 12 (heart) refused: too large")) << "one's own word";
  for (const char* other : {"", "master", "master: ", "master: done", "master: contour 123 (heart) refused",
                            "master: no contour 1 waits here, but contour 12 (heart)", "contour 12 refused"})
    EXPECT_FALSE(refuses(other)) << other;
}

TEST_F(Contours, ARebuildTakesTheNewestAgain) {
  const std::uint32_t id = publish(7);
  ASSERT_TRUE(sees(id));
  scale = 0.5;
  subscriber.request_rebuild();
  EXPECT_TRUE(soon([&] { return subscriber.current()->scale == 0.5; }));
  EXPECT_EQ(subscriber.current()->id, id);
  too_large = true;  // then what was in force stays, and nothing ends
  scale = 2.0;
  subscriber.request_rebuild();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(subscriber.current()->scale, 0.5);
  EXPECT_FALSE(subscriber.refused());
}

TEST_F(Contours, AFirstOneThatDoesNotFitIsRefusedOnceAndTheNextThatFitsIsInForce) {
  too_large = true;
  publish(1);
  ASSERT_TRUE(soon([&] { return subscriber.refused(); }));
  EXPECT_EQ(subscriber.refusal(), "too large");
  EXPECT_EQ(subscriber.current(), nullptr);
  publish(1);
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(subscriber.unfit(), 1u) << "the same one again is no other refusal";
  too_large = false;
  publish(1);
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(subscriber.current(), nullptr) << "nor fits it by itself";
  EXPECT_TRUE(sees(publish(2)));
  EXPECT_FALSE(subscriber.refused());
}

TEST_F(Contours, AFirstOneThatDidNotFitIsTriedAgainWhereItsPreparationChanges) {
  too_large = true;
  const std::uint32_t id = publish(1);
  ASSERT_TRUE(soon([&] { return subscriber.refused(); }));
  subscriber.request_rebuild();
  EXPECT_TRUE(soon([&] { return subscriber.unfit() == 2; }));
  too_large = false;
  subscriber.request_rebuild();
  EXPECT_TRUE(sees(id));
  EXPECT_FALSE(subscriber.refused());
  const std::uint32_t other = publish(2);
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(subscriber.current()->id, id) << "one is in force now: another waits for the operator";
  EXPECT_TRUE(takes(other));
}

TEST_F(Contours, InMidRunARefusedOneLeavesTheOneBeforeInForce) {
  const std::uint32_t id = publish(1);
  ASSERT_TRUE(sees(id));
  too_large = true;
  const std::uint32_t large = publish(2);
  EXPECT_TRUE(soon([&] {
    take(large);
    std::this_thread::sleep_for(20ms);
    return subscriber.unfit() == 1;
  }));
  too_large = false;
  publish(3, 1);  // another one's id
  EXPECT_TRUE(soon([&] { return subscriber.unfit() == 2; }));
  EXPECT_FALSE(subscriber.refused());
  EXPECT_EQ(subscriber.current()->id, id);
}

TEST_F(Contours, AnotherOneWaitsUntilItIsTaken) {
  const std::uint32_t first = publish(1);
  ASSERT_TRUE(sees(first));
  const std::uint32_t second = publish(2);
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(subscriber.current()->id, first);
  take(second + 1);  // nobody's
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(subscriber.current()->id, first);
  EXPECT_TRUE(takes(second));
  EXPECT_EQ(subscriber.message().id, second);
  EXPECT_EQ(subscriber.unfit(), 0u);
}

TEST_F(Contours, OfManyASecondTheLastIsLookedAt) {
  ASSERT_TRUE(sees(publish(1)));
  std::uint32_t last = 0;
  for (std::uint32_t number = 2; number < 40; ++number) last = publish(number, number < 39 ? 1 : 0);
  EXPECT_TRUE(takes(last));
  EXPECT_LT(subscriber.unfit(), 20u) << "38 had come";
}

TEST_F(Contours, TheSameOneAgainChangesNothing) {
  const std::uint32_t id = publish(1);
  ASSERT_TRUE(sees(id));
  const Prepared* const before = subscriber.current();
  publish(1);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(subscriber.current(), before);
}

}  // namespace
}  // namespace telekerf
