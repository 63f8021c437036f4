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
  std::int64_t now_ns = 3'600'000'000'000;
  const StateHeader good = state(0.1, false), late = state(0.62, true);
  const auto due = [&](const StateHeader* slave, int pass_ms) {
    for (int ms = 0; ms < pass_ms; ms += 10) words.step(now_ns += 10'000'000, 0.0, slave);
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

/// The sentence `ms` after a standstill, of which the slave's commands are old for as long.
std::string said_after(double stood_s, bool other_side, int ms) {
  LinkWords words;
  std::chrono::steady_clock::time_point now;
  std::int64_t now_ns = 3'600'000'000'000;
  const StateHeader good = state(0.1, false), late = state(1.5, true);
  words.step(now_ns, 0.0, &good);
  (void)words.due(now);
  const auto stood_ns = static_cast<std::int64_t>(stood_s * 1e9);
  words.step(now_ns += other_side ? 1'000'000 : stood_ns, other_side ? stood_s : 0.0, &late);
  std::string said;
  for (int passed = 0; passed < ms; passed += 10) {
    words.step(now_ns += 10'000'000, 0.0, &late);
    said += words.due(now += milliseconds(10));
  }
  return said;
}

TEST(LinkWords, BlameTheLinkForNoStandstillOfEitherSide) {
  for (const bool other_side : {false, true}) {
    EXPECT_EQ(said_after(1.0, other_side, 2900), "");
    EXPECT_NE(said_after(1.0, other_side, 4000).find("1.50 s old"), std::string::npos) << "it is the link";
    EXPECT_NE(said_after(0.1, other_side, 700).find("1.50 s old"), std::string::npos) << "a few blocks were lost";
  }
}

TEST(LinkWords, AnUnknownAgeIsNoLateness) {
  LinkWords words;
  const StateHeader unknown = state(-1.0, true);
  words.step(1, 0.0, &unknown);
  EXPECT_EQ(words.due(std::chrono::steady_clock::time_point(std::chrono::hours(1))), "");
  EXPECT_EQ(link_sentence(-1.0), "");
}

}  // namespace
}  // namespace telekerf::master
