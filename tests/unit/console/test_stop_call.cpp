// SPDX-License-Identifier: Apache-2.0
// The page's stop in virtual time.
#include <gtest/gtest.h>

#include "master/console/stop_call.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

PresenceMessage present(const std::string& role, const std::string& name, std::uint32_t epoch) {
  PresenceMessage message;
  message.role = role;
  message.name = name;
  message.epoch = epoch;
  return message;
}

class StopCallTest : public ::testing::Test {
 protected:
  StopMessage obeyed(std::uint32_t epoch, std::uint32_t number, bool set,
                     const std::string& source = "operator") {
    return {.epoch = epoch, .number = number, .source = source, .set = set, .obeyed = true, .reason = "why"};
  }
  /// Said within the next `ms`.
  int said(int ms) {
    int count = 0;
    for (int n = 0; n < ms; ++n, now_ns += kMs) {
      if (const auto message = call.step(others, now_ns)) {
        ++count;
        last = *message;
      }
    }
    return count;
  }

  StopCall call{"operator", 9};
  std::vector<PresenceMessage> others{present("master", "m", 1), present("slave", "s", 2),
                                      present("vision", "v", 3)};
  StopMessage last;
  std::int64_t now_ns = 0;
};

TEST_F(StopCallTest, IsSaidAtOnceAndUntilAllStationsHaveObeyed) {
  EXPECT_EQ(said(100), 0);
  call.stop(77, "because", now_ns);
  EXPECT_TRUE(call.in_force());
  EXPECT_EQ(said(1), 1) << "at once";
  EXPECT_EQ(last.number, 77u);
  EXPECT_TRUE(last.set);
  EXPECT_GE(said(1000), 49) << "every 20 ms";
  call.hear(obeyed(1, 77, true));
  EXPECT_GE(said(100), 4) << "the slave has not answered";
  call.hear(obeyed(2, 77, true));
  EXPECT_EQ(said(100), 0);
  EXPECT_TRUE(call.in_force());
  EXPECT_EQ(call.sentence(), "Stopped by operator: why");
}

TEST_F(StopCallTest, WhoDoesNotAnswerIsNamed) {
  call.stop(77, "because", now_ns);
  call.hear(obeyed(1, 77, true));
  said(6000);
  EXPECT_EQ(said(100), 0);
  EXPECT_EQ(call.sentence(), "The stop was not confirmed by s: see to it at the machine");
}

TEST_F(StopCallTest, IsEndedByWhoSaidItAlone) {
  EXPECT_EQ(call.clear(now_ns), "No stop is in force");
  for (const std::uint32_t station : {1u, 2u}) call.hear(obeyed(station, 5, true, "guard"));
  EXPECT_EQ(call.clear(now_ns), "The stop was said by guard, and nobody else clears it");
  for (const std::uint32_t station : {1u, 2u}) call.hear(obeyed(station, 5, false, "guard"));
  EXPECT_FALSE(call.in_force());
  for (const std::uint32_t station : {1u, 2u}) call.hear(obeyed(station, 6, true));
  EXPECT_EQ(call.clear(now_ns), "");
  EXPECT_EQ(said(1), 1);
  EXPECT_FALSE(last.set);
  EXPECT_EQ(last.number, 6u);
  for (const std::uint32_t station : {1u, 2u}) call.hear(obeyed(station, 6, false));
  said(1000);
  EXPECT_FALSE(call.in_force());
  EXPECT_EQ(call.sentence(), "");
}

}  // namespace
}  // namespace telekerf::master
