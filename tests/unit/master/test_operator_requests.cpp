// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "master/operator_requests.h"

namespace telekerf::master {
namespace {

using Kind = EventMessage::Kind;

bool hear(OperatorRequests& requests, Kind kind, double value = 0.0) {
  EventMessage event;
  event.kind = kind;
  event.value = value;
  return requests.hear({&event, 1}, {}).rescale;
}

TEST(OperatorRequests, TheLastWordOnEngagingHolds) {
  OperatorRequests requests(false, 0.5);
  EXPECT_FALSE(requests.engage());
  EXPECT_FALSE(hear(requests, Kind::kEngage));
  EXPECT_TRUE(requests.engage());
  requests.spend_engage();
  EXPECT_FALSE(requests.engage());
  hear(requests, Kind::kEngage);
  hear(requests, Kind::kDisengage);
  EXPECT_FALSE(requests.engage());
}

TEST(OperatorRequests, AScaleIsAskedForOnceAndWithinBounds) {
  OperatorRequests requests(false, 0.5);
  EXPECT_FALSE(hear(requests, Kind::kSetBeta, 0.5)) << "it is so already";
  for (const double beta :
       {0.0, -1.0, 0.5 * kSmallestBeta, 2.0 * kLargestBeta, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(hear(requests, Kind::kSetBeta, beta)) << beta;
  }
  EXPECT_TRUE(hear(requests, Kind::kSetBeta, 0.8));
  EXPECT_FALSE(hear(requests, Kind::kSetBeta, 0.8));
  EXPECT_EQ(requests.wanted_beta(), 0.8);
}

TEST(OperatorRequests, ARefusedScaleGivesWayToTheLastOneThatWasGranted) {
  OperatorRequests requests(false, 0.5);
  requests.granted(0.5);
  hear(requests, Kind::kSetBeta, 0.8);
  requests.granted(0.8);
  hear(requests, Kind::kSetBeta, 0.1);
  requests.refused(0.1);
  EXPECT_EQ(requests.wanted_beta(), 0.8);
  EXPECT_TRUE(hear(requests, Kind::kSetBeta, 0.1)) << "and may be asked for again";

  hear(requests, Kind::kSetBeta, 0.9);
  requests.refused(0.1);
  EXPECT_EQ(requests.wanted_beta(), 0.9) << "another was asked for meanwhile";
}

TEST(OperatorRequests, AnEngagementThatCannotBeginIsNotKeptForLater) {
  const OperatorRequests::Waiting waiting{.passed_s = 1e-3, .most_s = 0.35, .guiding = true};
  const auto wait = [](OperatorRequests& requests, double seconds, const OperatorRequests::Waiting& now) {
    for (int n = 0; n < static_cast<int>(seconds * 1e3 + 0.5); ++n)
      EXPECT_EQ(requests.wait(now), nullptr) << n;
    EXPECT_TRUE(requests.engage());
  };
  const auto over = [&](double seconds, const OperatorRequests::Waiting& at_last) {
    OperatorRequests requests(false, 0.5);
    hear(requests, Kind::kEngage);
    wait(requests, seconds, waiting);
    const char* why = requests.wait(at_last);
    EXPECT_FALSE(requests.engage());
    EXPECT_EQ(requests.wait(at_last), nullptr) << "said once";
    hear(requests, Kind::kEngage);
    wait(requests, 4.995, waiting);
    return std::string(why == nullptr ? "" : why);
  };
  auto later = waiting;
  later.passed_s = 0.01;
  EXPECT_NE(over(4.995, later).find("within 5 s"), std::string::npos);
  later.passed_s = 0.351;
  EXPECT_NE(over(0.1, later).find("stood still"), std::string::npos);
  later = waiting;
  later.slave_gone = true;
  EXPECT_NE(over(0.1, later).find("not heard any more"), std::string::npos);

  auto approaching = waiting;
  approaching.guiding = false;
  OperatorRequests requests(false, 0.5);
  hear(requests, Kind::kEngage);
  wait(requests, 30.0, approaching);
  OperatorRequests asked_at_the_start(true, 0.5);
  later.passed_s = 60.0;
  wait(asked_at_the_start, 0.01, later);
}

TEST(OperatorRequests, WhatIsRefusedIsSaidAndChangesNothing) {
  OperatorRequests requests(false, 0.5);
  const auto refusal = [&](Kind kind, double value, const OperatorRequests::Situation& now) {
    EventMessage event;
    event.kind = kind;
    event.value = value;
    return requests.hear({&event, 1}, now).refusal != nullptr;
  };
  EXPECT_TRUE(refusal(Kind::kEngage, 0.0, {.stopped = true, .beam_on = false}));
  EXPECT_TRUE(refusal(Kind::kSetBeta, 0.8, {.stopped = true, .beam_on = false}));
  EXPECT_TRUE(refusal(Kind::kSetBeta, 0.8, {.stopped = false, .beam_on = true}));
  EXPECT_TRUE(refusal(Kind::kSetBeta, 99.0, {}));
  EXPECT_FALSE(requests.engage());
  EXPECT_EQ(requests.wanted_beta(), 0.5);
  EXPECT_FALSE(refusal(Kind::kDisengage, 0.0, {.stopped = true, .beam_on = true}));
  EXPECT_FALSE(refusal(Kind::kEngage, 0.0, {.stopped = false, .beam_on = true}));
}

}  // namespace
}  // namespace telekerf::master
