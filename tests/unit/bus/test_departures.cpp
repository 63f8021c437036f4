// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/bus/departures.h"

namespace telekerf::bus {
namespace {

using Clock = Departures::Clock;
using std::chrono::milliseconds;

Departures::Key key_of(std::uint8_t number) {
  Departures::Key key{};
  key[11] = number;
  return key;
}
Neighbour slave() {
  Neighbour who{.presence = {}, .key = key_of(1)};
  who.presence.role = "slave";
  return who;
}

TEST(Departures, WhoIsHeardLongAfterItsFarewellIsThere) {
  Departures departures;
  const Clock::time_point now{};
  departures.note(key_of(1), slave(), now);
  EXPECT_FALSE(departures.heard(key_of(1), now + milliseconds(3999))) << "was under way";
  EXPECT_FALSE(departures.heard(key_of(2), now + milliseconds(9000))) << "nobody has known that one";
  const auto who = departures.heard(key_of(1), now + milliseconds(4000));
  ASSERT_TRUE(who);
  EXPECT_EQ(who->presence.role, "slave");
  EXPECT_FALSE(departures.heard(key_of(1), now + milliseconds(9000))) << "it has not left again";
}

TEST(Departures, AreBounded) {
  Departures departures;
  const Clock::time_point now{};
  for (std::size_t n = 0; n <= Departures::kMost; ++n)
    departures.note(key_of(static_cast<std::uint8_t>(n)), slave(), now);
  EXPECT_FALSE(departures.heard(key_of(0), now + milliseconds(4000)));
  EXPECT_TRUE(departures.heard(key_of(Departures::kMost), now + milliseconds(4000)));
}

}  // namespace
}  // namespace telekerf::bus
