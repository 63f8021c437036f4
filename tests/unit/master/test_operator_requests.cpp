// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
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

TEST(OperatorRequests, NobodyEngagesWhileTheCommandStreamIsBeingChanged) {
  OperatorRequests requests(false, 0.5);
  EventMessage event;
  event.kind = Kind::kEngage;
  EXPECT_STREQ(requests.hear({&event, 1}, {.stream_changes = true}).refusal,
               "refused: law, estimator or codec are just being changed; engage when they are");
  EXPECT_FALSE(requests.engage());
  EXPECT_EQ(requests.hear({&event, 1}, {}).refusal, nullptr);
  EXPECT_TRUE(requests.engage());
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
  const OperatorRequests::Waiting waiting{.guiding = true, .most_s = 0.35};
  std::int64_t now_ns = 1'000'000'000;
  const auto step = [&](OperatorRequests& requests, double passed_s, const OperatorRequests::Waiting& now) {
    now_ns += std::llround(1e9 * passed_s);
    const char* why = requests.wait(now_ns, now);
    return std::string(why == nullptr ? "" : why);
  };
  const auto wait = [&](OperatorRequests& requests, int steps, const OperatorRequests::Waiting& now) {
    for (int n = 0; n < steps; ++n) EXPECT_EQ(step(requests, 1e-3, now), "") << n;
    EXPECT_TRUE(requests.engage());
  };
  const auto over = [&](int steps, double passed_s, const OperatorRequests::Waiting& at_last,
                        const OperatorRequests::Waiting& until_then) {
    OperatorRequests requests(false, 0.5);
    hear(requests, Kind::kEngage);
    wait(requests, steps, until_then);
    const std::string why = step(requests, passed_s, at_last);
    EXPECT_FALSE(requests.engage());
    EXPECT_EQ(step(requests, passed_s, at_last), "") << "said once";
    hear(requests, Kind::kEngage);
    wait(requests, 4995, waiting);
    return why;
  };
  EXPECT_NE(over(4995, 0.01, waiting, waiting).find("within 5 s"), std::string::npos);
  EXPECT_NE(over(100, 0.351, waiting, waiting).find("stood still"), std::string::npos);
  auto gone = waiting;
  gone.slave_gone = true;
  EXPECT_NE(over(499, 2e-3, gone, gone).find("not heard any more"), std::string::npos);

  auto approaching = waiting;
  approaching.guiding = false;
  auto led = gone;
  led.led = true;
  OperatorRequests requests(false, 0.5);
  hear(requests, Kind::kEngage);
  wait(requests, 30'000, approaching);
  wait(requests, 30'000, led);
  OperatorRequests asked_at_the_start(true, 0.5);
  EXPECT_EQ(step(asked_at_the_start, 60.0, gone), "");
  wait(asked_at_the_start, 30'000, waiting);

  OperatorRequests back_again(false, 0.5);
  hear(back_again, Kind::kEngage);
  for (int n = 0; n < 8; ++n) {
    wait(back_again, 490, gone);
    wait(back_again, 1, waiting);
  }
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
