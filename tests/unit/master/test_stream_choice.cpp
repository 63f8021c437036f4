// SPDX-License-Identifier: Apache-2.0
// Law, estimator and codec as an operator asks for them.
#include <gtest/gtest.h>

#include <string>

#include "master/law.h"
#include "master/observer/estimators.h"
#include "master/station_settings.h"
#include "master/stream_choice.h"

namespace telekerf::master {
namespace {

EventMessage asking(const std::string& words) {
  return {.epoch = 9, .kind = EventMessage::Kind::kSetStream, .value = 0.0, .text = words};
}

TEST(StreamChoice, TakesTheWordsOfTheSettings) {
  StreamChoice choice;
  for (const auto& row : kLaws) {
    ASSERT_EQ(choice.change("law " + std::string(row.word)), nullptr);
    EXPECT_EQ(with_choice({}, choice).node.command.law, row.value);
  }
  for (const auto& row : kEstimators) {
    ASSERT_EQ(choice.change("estimator " + std::string(row.word)), nullptr);
    EXPECT_EQ(with_choice({}, choice).node.command.observer.estimator, row.value);
  }
  for (const auto& row : codec::kCodecs) {
    ASSERT_EQ(choice.change("codec " + std::string(row.word)), nullptr);
    EXPECT_EQ(with_choice({}, choice).codec, row.value);
  }
  EXPECT_EQ(choice.change("block 64"), nullptr);
  EXPECT_EQ(choice.change("keep 1"), nullptr);
  EXPECT_EQ(choice.change("redundancy 0"), nullptr);
  const StationSettings settings = with_choice({}, choice);
  EXPECT_EQ(settings.node.command.codec.block, 64);
  EXPECT_EQ(settings.node.command.codec.keep, 1);
  EXPECT_EQ(settings.node.command.codec.redundancy, 0);
  EXPECT_EQ(choice_of(settings), choice);
}

TEST(StreamChoice, WhatCannotChangeIsRefusedAndChangesNothing) {
  const StreamChoice before = choice_of({});
  for (const char* words :
       {"law", "law none", "law anchored ", "estimator raw", "codec zip", "block 3", "block 65", "block 16.5",
        "keep 0", "keep 65", "redundancy 8", "redundancy -1", "block ", ""}) {
    StreamChoice choice = before;
    const char* const refusal = choice.change(words);
    ASSERT_NE(refusal, nullptr) << words;
    EXPECT_EQ(std::string(refusal).rfind("refused: ", 0), 0u) << refusal;
    EXPECT_EQ(choice, before) << words;
  }
  StreamChoice choice = before;
  EXPECT_NE(std::string(choice.change("stream_hz 500")).find("rates and all else are set when it starts"),
            std::string::npos);
}

TEST(StreamChoice, BoundsInTheRefusalsAreThoseOfTheSettings) {
  const auto says = [](const char* words, const Bounds& bounds) {
    StreamChoice choice;
    const std::string range = "[" + std::to_string(static_cast<int>(bounds.min)) + ", " +
                              std::to_string(static_cast<int>(bounds.max)) + "]";
    return std::string(choice.change(words)).find(range) != std::string::npos;
  };
  EXPECT_TRUE(says("block 99", kBlockSamples));
  EXPECT_TRUE(says("keep 99", kKeptCoefficients));
  EXPECT_TRUE(says("redundancy 99", kCopies));
}

TEST(StreamRequests, AreHeardBetweenTwoEngagementsOnly) {
  StreamRequests requests{StreamChoice{}};
  EXPECT_NE(requests.hear(asking("block 32"), {.stopped = true}), nullptr);
  EXPECT_NE(requests.hear(asking("block 32"), {.led = true}), nullptr);
  EXPECT_NE(requests.hear(asking("block 32"), {.beam_on = true}), nullptr);
  EXPECT_FALSE(requests.pending());
  EXPECT_EQ(requests.hear(asking("block 32"), {}), nullptr);
  EXPECT_TRUE(requests.pending());
}

TEST(StreamRequests, OneAfterTheOtherComeTogetherAndTheSameTwiceIsOne) {
  StreamRequests requests{StreamChoice{}};
  ASSERT_EQ(requests.hear(asking("block 32"), {}), nullptr);
  ASSERT_EQ(requests.hear(asking("block 32"), {}), nullptr) << "events may come twice";
  const StreamChoice first = requests.wanted();
  ASSERT_EQ(requests.hear(asking("keep 8"), {}), nullptr);
  EXPECT_FALSE(requests.grant(first)) << "made too early";
  const StreamChoice both = requests.wanted();
  EXPECT_EQ(both.block, 32);
  EXPECT_EQ(both.keep, 8);
  EXPECT_TRUE(requests.grant(both));
  EXPECT_FALSE(requests.pending());
  EXPECT_FALSE(requests.grant(both)) << "once";
  EXPECT_EQ(requests.hear(asking("keep 8"), {}), nullptr);
  EXPECT_FALSE(requests.pending()) << "it is so already";
}

TEST(StreamRequests, WhatCannotBeMadeGivesWayToWhatIsInForceAndTheAskerIsTold) {
  StreamRequests requests{StreamChoice{}};
  ASSERT_EQ(requests.hear(asking("block 64"), {}), nullptr);
  EXPECT_EQ(requests.take_refused(), 0u);
  requests.refuse(requests.wanted());
  EXPECT_FALSE(requests.pending());
  EXPECT_EQ(requests.take_refused(), 9u);
  EXPECT_EQ(requests.take_refused(), 0u);

  ASSERT_EQ(requests.hear(asking("block 64"), {}), nullptr);
  const StreamChoice tried = requests.wanted();
  ASSERT_EQ(requests.hear(asking("block 8"), {}), nullptr);
  requests.refuse(tried);
  EXPECT_TRUE(requests.pending()) << "another was asked for meanwhile";
  EXPECT_EQ(requests.wanted().block, 8);
}

}  // namespace
}  // namespace telekerf::master
