// SPDX-License-Identifier: Apache-2.0
#include "master/link_words.h"

#include <gtest/gtest.h>

namespace telekerf::master {
namespace {

using std::chrono::milliseconds;

StateHeader state(double age_s, bool late) {
  StateHeader header;
  header.command_age_s = age_s;
  header.guards = late ? kAgeGuard : 0;
  return header;
}

TEST(LinkWords, SayItAtOnceAndAgainWhileItLasts) {
  LinkWords words;
  std::chrono::steady_clock::time_point now;
  const StateHeader good = state(0.1, false), late = state(0.62, true);
  const auto due = [&](const StateHeader* slave, int pass_ms) {
    words.step(slave);
    return words.due(now += milliseconds(pass_ms));
  };
  EXPECT_EQ(due(nullptr, 10), "");
  EXPECT_EQ(due(&good, 10), "");
  EXPECT_EQ(due(&late, 300), "") << "a moment is no word worth";
  const std::string said = due(&late, 300);
  EXPECT_NE(said.find("0.62 s old"), std::string::npos) << said;
  EXPECT_NE(said.find("--beam-age-s"), std::string::npos) << said;
  EXPECT_EQ(due(&late, 4000), "");
  EXPECT_EQ(due(&late, 1100), said) << "it lasts";
  EXPECT_EQ(due(&good, 20), "the link is fast enough for the laser again");
  EXPECT_EQ(due(&good, 20), "");
}

TEST(LinkWords, AnUnknownAgeIsNoLateness) {
  LinkWords words;
  const StateHeader unknown = state(-1.0, true);
  words.step(&unknown);
  EXPECT_EQ(words.due(std::chrono::steady_clock::time_point(std::chrono::hours(1))), "");
  EXPECT_EQ(link_sentence(-1.0), "");
}

}  // namespace
}  // namespace telekerf::master
