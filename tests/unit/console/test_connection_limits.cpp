// SPDX-License-Identifier: Apache-2.0
// Who may connect how often, and what is said of those who were refused.
#include <gtest/gtest.h>

#include "master/console/access.h"
#include "master/console/connection_limits.h"

namespace telekerf::master {
namespace {

using boost::asio::ip::make_address;

int admitted(ConnectionLimits& limits, const std::string& from, int wanted) {
  int count = 0;
  for (int n = 0; n < wanted; ++n) count += limits.admit(make_address(from)) ? 1 : 0;
  return count;
}

TEST(ConnectionLimits, OneComputerLeavesRoomForOthersAndOthersForThisOne) {
  ConnectionLimits limits;
  EXPECT_EQ(admitted(limits, "192.168.1.7", 1000), ConnectionLimits::kMostOfOne);
  EXPECT_EQ(admitted(limits, "192.168.1.8", 1000), ConnectionLimits::kMostOfOthers - ConnectionLimits::kMostOfOne);
  EXPECT_EQ(admitted(limits, "192.168.1.9", 10), 0);
  EXPECT_EQ(admitted(limits, "127.0.0.1", 1000), ConnectionLimits::kMostOfOne);
  EXPECT_EQ(limits.open(), ConnectionLimits::kMost);
  limits.leave(make_address("192.168.1.8"));
  EXPECT_EQ(admitted(limits, "192.168.1.7", 10), 0) << "it has its share";
  EXPECT_EQ(admitted(limits, "192.168.1.9", 10), 1);
}

TEST(ConnectionLimits, TheAddressesOfOneNetworkOfIPv6AndAMappedOneAreOneComputers) {
  ConnectionLimits limits;
  for (int n = 0; n < ConnectionLimits::kMostOfOne; ++n)
    ASSERT_TRUE(limits.admit(make_address("2001:db8::" + std::to_string(n + 1))));
  EXPECT_FALSE(limits.admit(make_address("2001:db8::ffff:1")));
  EXPECT_TRUE(limits.admit(make_address("2001:db8:0:1::1")));
  EXPECT_EQ(admitted(limits, "::ffff:127.0.0.1", 20), 20);
  EXPECT_EQ(admitted(limits, "127.0.0.1", 20), 4);
}

TEST(ConnectionLimits, RefusalsAreCountedAndSaidNowAndThen) {
  ConnectionLimits limits;
  constexpr std::int64_t kSecond = 1'000'000'000;
  EXPECT_EQ(limits.due(kSecond), "");
  admitted(limits, "10.0.0.5", 25);
  EXPECT_EQ(limits.due(kSecond),
            "1 connection of a browser was refused, the last one of 10.0.0.5: 24 of 10.0.0.5 are open, as many as one "
            "computer may have; close pages there");
  admitted(limits, "10.0.0.5", 7);
  EXPECT_EQ(limits.due(2 * kSecond), "") << "not each";
  EXPECT_TRUE(limits.due(12 * kSecond).starts_with("7 connections of browsers were refused"));
  EXPECT_EQ(limits.due(30 * kSecond), "");
  EXPECT_EQ(limits.refused(), 8u);
}

TEST(ConnectionLimits, ThatNoneCanBeTakenIsCountedAndSaidOnceUntilOneWas) {
  ConnectionLimits limits;
  constexpr std::int64_t kSecond = 1'000'000'000;
  for (std::int64_t s = 1; s < 100; ++s) {
    limits.wait("Too many open files");
    EXPECT_EQ(limits.due(s * kSecond),
              s > 1 ? ""
                    : "browsers that want to connect have to wait: Too many open files; close pages, or let this process "
                      "open more files (LimitNOFILE of its service, ulimit -n)");
  }
  EXPECT_EQ(limits.waits(), 99u);
  ASSERT_TRUE(limits.admit(make_address("10.0.0.5")));
  limits.wait("Too many open files");
  EXPECT_NE(limits.due(100 * kSecond), "") << "again";
  ASSERT_TRUE(limits.admit(make_address("10.0.0.5")));
  limits.wait("Too many open files");
  EXPECT_EQ(limits.due(101 * kSecond), "") << "but not each second";
}

TEST(Warning, IsForWhatOthersCouldReadAndNamesTheRemedy) {
  for (const char* own : {"127.0.0.1", "127.0.0.7", "::1"}) EXPECT_EQ(warning_of(own, false, false), "") << own;
  for (const char* open : {"0.0.0.0", "192.168.1.7", "::"}) {
    EXPECT_EQ(warning_of(open, true, false), "") << open;
    const std::string bare = warning_of(open, false, false), token = warning_of(open, false, true);
    EXPECT_NE(bare.find("anyone in that network may watch and stop"), bare.npos) << bare;
    EXPECT_NE(bare.find("--tls-cert and --tls-key"), bare.npos);
    EXPECT_NE(bare.find("--token TEXT"), bare.npos);
    EXPECT_NE(token.find("learns the token and drives"), token.npos) << token;
    EXPECT_EQ(token.find("--token TEXT"), token.npos);
  }
}

}  // namespace
}  // namespace telekerf::master
