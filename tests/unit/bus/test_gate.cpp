// SPDX-License-Identifier: Apache-2.0
// What a secured participant lets in, whom it does not hear for a while, and to whom it says farewell so that
// a handshake begins anew.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <random>
#include <utility>
#include <vector>

#include "common/bus/gate.h"
#include "common/bus/reunion.h"

namespace telekerf {
namespace {

using namespace std::chrono_literals;

/// A datagram of this prefix with one submessage: its kind and the octets behind its head.
std::vector<std::byte> datagram(const bus::Gate::Prefix& prefix, std::uint8_t kind,
                                std::vector<std::uint8_t> rest) {
  std::vector<std::uint8_t> octets{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  octets.insert(octets.end(), prefix.begin(), prefix.end());
  octets.insert(octets.end(), {kind, 1, static_cast<std::uint8_t>(rest.size()), 0});
  octets.insert(octets.end(), rest.begin(), rest.end());
  std::vector<std::byte> bytes(octets.size());
  std::memcpy(bytes.data(), octets.data(), octets.size());
  return bytes;
}

std::vector<std::uint8_t> data_of(std::uint32_t entity) {
  std::vector<std::uint8_t> octets{0, 0, 16, 0, 0, 0, 0, 0};
  for (int i = 3; i >= 0; --i) octets.push_back(static_cast<std::uint8_t>(entity >> 8 * i));
  octets.insert(octets.end(), 16, 0);
  return octets;
}

struct Said {
  std::uint32_t lease_s = 5;
  std::uint32_t mask = 0x80000007, kind = 0x8000003e;  ///< signed, as our governance asks for
};

/// A participant's announcement, with inline QoS or without.
std::vector<std::byte> announcement(const bus::Gate::Prefix& prefix, const Said& said = {},
                                    bool qos = false) {
  auto octets = data_of(bus::kAnnouncements);
  octets.resize(20);
  const auto add = [&](std::initializer_list<std::uint8_t> more) { octets.insert(octets.end(), more); };
  const auto word = [&](std::uint32_t value) {
    for (int i = 0; i < 4; ++i) octets.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  };
  if (qos) add({0x70, 0, 4, 0, 1, 2, 3, 4, 1, 0, 0, 0});
  add({0, 3, 0, 0});  // a little-endian list of parameters
  add({0x02, 0, 8, 0});
  word(said.lease_s);
  word(0);
  add({0x05, 0x10, 8, 0});
  word(said.mask);
  word(said.kind);
  add({1, 0, 0, 0});
  auto bytes = datagram(prefix, 0x15, octets);
  bytes[21] = std::byte(qos ? 0x07 : 0x05);
  return bytes;
}

TEST(Gate, LetsInWhatIsProtectedAndWhatComesBeforeKeysAndNothingElse) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}, {0x80, 9, 9, 9, 9, 9}});
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7},
      none{0x90, 1, 2, 3, 4, 6, 7, 7, 7, 7, 7, 7};
  const auto admits = [&](const std::vector<std::byte>& bytes) { return gate.admits(bytes, 1, 1); };
  const std::vector<std::uint8_t> secured{1, 2, 3, 4};
  EXPECT_TRUE(admits(datagram(ours, 0x33, secured)));
  EXPECT_FALSE(admits(datagram(none, 0x33, secured)));
  EXPECT_TRUE(admits(announcement(ours)));
  EXPECT_TRUE(admits(announcement(ours, {}, true)));
  EXPECT_TRUE(admits(datagram(ours, 0x15, data_of(0x000201c3)))) << "a handshake";
  EXPECT_FALSE(admits(datagram(ours, 0x15, data_of(0x00531003)))) << "a block";
  EXPECT_FALSE(admits(datagram(ours, 0x15, data_of(0x000003c2)))) << "a writer's announcement in the clear";
  EXPECT_FALSE(admits(announcement(none)));
  EXPECT_FALSE(admits(datagram(ours, 0x15, data_of(0x000100c2)))) << "an announcement of nothing";
  EXPECT_FALSE(admits(datagram(ours, 0x16, data_of(0x000100c2)))) << "a part of one";
  EXPECT_FALSE(admits(announcement(ours, {.mask = 0}))) << "without keys, in the name of one who has some";
  EXPECT_FALSE(admits(announcement(ours, {.lease_s = 21}))) << "wants to be remembered for long";
  EXPECT_FALSE(admits(datagram(ours, 0x0c, std::vector<std::uint8_t>(20, 0)))) << "speaks in another's name";
  auto hidden = datagram(ours, 0x09, std::vector<std::uint8_t>(8, 0));
  const auto behind = datagram(ours, 0x33, secured);
  hidden.insert(hidden.end(), behind.begin() + 20, behind.end());
  EXPECT_FALSE(admits(hidden)) << "protected, but not as a whole";
  EXPECT_FALSE(admits({}));
  EXPECT_FALSE(admits(std::vector<std::byte>(20)));
  EXPECT_EQ(gate.refused(), 12u);
}

TEST(Gate, OfEachIdentityOnlyAFewAreUnderWayUntilTheyProveIt) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
  const auto announces = [&](std::uint8_t which, std::int64_t now_ns) {
    prefix[11] = which;
    return gate.admits(announcement(prefix), 1, now_ns);
  };
  int admitted = 0;
  for (int i = 0; i < 100; ++i) admitted += announces(static_cast<std::uint8_t>(i), 1000) ? 1 : 0;
  EXPECT_EQ(admitted, static_cast<int>(bus::Gate::kUnproven));
  EXPECT_TRUE(announces(0, 1000));
  prefix[11] = 0;
  EXPECT_EQ(gate.unproven_from(prefix), 1u);
  EXPECT_TRUE(gate.admits(announcement(prefix), 2, 1000));
  EXPECT_EQ(gate.unproven_from(prefix), 2u) << "where it was heard last";
  gate.proven(prefix, 1000);
  EXPECT_EQ(gate.unproven_from(prefix), 0u);
  EXPECT_TRUE(announces(50, 1000)) << "its place is free";
  EXPECT_TRUE(announces(0, 1000));
  EXPECT_FALSE(announces(51, 1000));
  EXPECT_TRUE(announces(51, 1001 + bus::Gate::kForgotten_ns));
}

constexpr std::int64_t kSecond_ns = 1'000'000'000;

class Crowd : public ::testing::Test {
 protected:
  bool announces(std::uint16_t which, std::int64_t now_ns) {
    bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
    prefix[10] = static_cast<std::uint8_t>(which >> 8);
    prefix[11] = static_cast<std::uint8_t>(which);
    return gate.admits(announcement(prefix), 1, now_ns);
  }
  /// Eight who say the same every three seconds, from one second on.
  void forge_until(std::int64_t now_ns) {
    for (; forged_ns <= now_ns; forged_ns += 3 * kSecond_ns)
      for (std::uint16_t n = 1000; n < 1008; ++n) announces(n, forged_ns);
  }
  bus::Gate gate{{{0x90, 1, 2, 3, 4, 5}}};
  std::int64_t forged_ns = kSecond_ns;
};

TEST_F(Crowd, EightWhoNeverProveItKeepANewcomerOutForTwoSecondsAtMost) {
  forge_until(kSecond_ns);
  EXPECT_FALSE(announces(1, kSecond_ns + 1));
  EXPECT_FALSE(announces(1, kSecond_ns + bus::Gate::kTrial_ns - 1)) << "they may be what they say";
  EXPECT_TRUE(announces(1, kSecond_ns + bus::Gate::kTrial_ns));
  // It is not taken away again by those who were there before.
  for (int tenth = 31; tenth < 200; ++tenth) {
    forge_until(tenth * kSecond_ns / 10);
    EXPECT_TRUE(announces(1, tenth * kSecond_ns / 10)) << tenth;
  }
}

TEST_F(Crowd, OneAfterAnotherComesThroughWhileTheyGoOn) {
  for (std::uint16_t newcomer = 1; newcomer < 40; ++newcomer) {
    const std::int64_t begin_ns = (10 + 4 * newcomer) * kSecond_ns;
    bool in = false;
    std::int64_t now_ns = begin_ns;
    for (; !in && now_ns < begin_ns + 4 * kSecond_ns; now_ns += kSecond_ns / 10) {
      forge_until(now_ns);
      in = announces(newcomer, now_ns);
    }
    ASSERT_TRUE(in) << newcomer;
    bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
    prefix[11] = static_cast<std::uint8_t>(newcomer);
    gate.proven(prefix, now_ns);
  }
}

TEST_F(Crowd, SeveralOfOneIdentityThatHaveProvedItGiveWayToNobody) {
  for (std::uint16_t n = 1; n <= 4; ++n) {
    bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
    prefix[11] = static_cast<std::uint8_t>(n);
    EXPECT_TRUE(announces(n, n));
    gate.proven(prefix, n);
  }
  std::mt19937 random(5);
  for (int tenth = 1; tenth < 600; ++tenth) {
    for (int n = 0; n < 5; ++n)
      announces(static_cast<std::uint16_t>(1000 + random() % 60'000), tenth * kSecond_ns / 10);
    if (tenth % 20 != 0) continue;
    for (std::uint16_t n = 1; n <= 4; ++n) {
      EXPECT_TRUE(announces(n, tenth * kSecond_ns / 10)) << n;
    }
  }
}

TEST_F(Crowd, HoweverManyComeOnlyAFewASecondAreLetIn) {
  std::mt19937 random(3);
  int admitted = 0;
  constexpr int kSeconds = 100;
  for (int n = 0; n < 1000 * kSeconds; ++n)
    admitted += announces(static_cast<std::uint16_t>(random()), (1000 + n) * (kSecond_ns / 1000)) ? 1 : 0;
  // Each is known for the time that it is heard; a hundred thousand draw from 65,536 names.
  EXPECT_LE(admitted, 2 * kSeconds);
}

TEST(Gate, WhoProtectsItsMessagesOtherwiseIsRememberedAndNotLetIn) {
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7};
  const Said signs, encrypts{.kind = 0x8000003f};
  for (const auto& [own, other] : {std::pair{bus::MessageProtection::kSigned, encrypts},
                                   std::pair{bus::MessageProtection::kEncrypted, signs}}) {
    bus::Gate gate({{0x90, 1, 2, 3, 4, 5}, {0x80, 9, 9, 9, 9, 9}}, own);
    EXPECT_TRUE(gate.otherwise(1).empty());
    EXPECT_FALSE(gate.admits(announcement(ours, other), 1, 5));
    EXPECT_EQ(gate.refused(), 0u) << "no stranger";
    ASSERT_EQ(gate.otherwise(6).size(), 1u);
    EXPECT_EQ(gate.otherwise(6).front(), (security::SubjectPrefix{0x90, 1, 2, 3, 4, 5}));
    EXPECT_TRUE(gate.otherwise(5 + bus::Gate::kForgotten_ns).empty());
    EXPECT_TRUE(
        gate.admits(announcement(ours, own == bus::MessageProtection::kSigned ? signs : encrypts), 1, 7));
  }
}

TEST(Gate, WhateverArrivesIsJudgedWithinItsBounds) {
  std::mt19937_64 random(24);
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7};
  for (int n = 0; n < 100'000; ++n) {
    auto bytes = announcement(ours, {}, n % 2 == 0);
    for (std::uint64_t i = random() % 6; i > 0; --i)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::byte>(random());
    bytes.resize(20 + random() % (bytes.size() - 19));
    (void)gate.admits(std::vector<std::byte>(bytes), 1, n);  // of just its size, for the sanitizers
  }
}

TEST(Gate, WhoSaysFarewellIsNotHeardUntilItsLeaseHasEnded) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7},
      another{0x90, 1, 2, 3, 4, 5, 8, 8, 8, 8, 8, 8}, to{1, 15};
  const auto announced = announcement(ours);
  const auto of_a_stream = datagram(ours, 0x33, {1, 2, 3, 4});
  constexpr std::int64_t kBegin_ns = 1'000'000'000;
  EXPECT_TRUE(gate.admits(announced, 1, kBegin_ns));
  EXPECT_FALSE(gate.admits(bus::farewell(ours, to), 1, kBegin_ns)) << "it is not passed on";
  const std::int64_t end_ns = kBegin_ns + bus::Gate::kDeaf_ns;
  for (const std::int64_t now_ns : {kBegin_ns, end_ns - 1}) {
    EXPECT_FALSE(gate.admits(announced, 1, now_ns));
    EXPECT_FALSE(gate.admits(of_a_stream, 1, now_ns)) << "its keys count no more";
    EXPECT_TRUE(gate.admits(datagram(another, 0x33, {1, 2, 3, 4}), 1, now_ns)) << "its next start";
  }
  EXPECT_TRUE(gate.admits(announced, 1, end_ns));
  EXPECT_TRUE(gate.admits(of_a_stream, 1, end_ns));
  EXPECT_EQ(gate.refused(), 0u) << "nobody without keys was there";
}

TEST(Gate, OfThoseWhoSaidFarewellTheLastOnesAreKnown) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
  for (std::uint8_t n = 0; n < 20; ++n) {
    prefix[11] = n;
    EXPECT_FALSE(gate.admits(bus::farewell(prefix, {}), 1, 1000 + n));
    EXPECT_FALSE(gate.admits(datagram(prefix, 0x33, {1, 2, 3, 4}), 1, 1000 + n));
  }
}

using Waiting = bus::Unproven;

TEST(Unproven, SaysFarewellOnceInAWhileUntilTheOtherHasProvedWhoItIs) {
  Waiting waiting;
  const Waiting::Key key{1, 2, 3};
  const Waiting::Time begin{};
  waiting.found(key, {}, begin);
  EXPECT_TRUE(waiting.due(begin + Waiting::kNew - 1ms).empty()) << "its handshake has just begun";
  EXPECT_EQ(waiting.due(begin + Waiting::kNew).size(), 1u);
  waiting.found(key, {}, begin + Waiting::kNew);  // announces itself now and then
  Waiting::Time next = begin + Waiting::kNew + Waiting::kAgain;
  EXPECT_TRUE(waiting.due(next - 1ms).empty());
  EXPECT_EQ(waiting.due(next).size(), 1u);
  EXPECT_TRUE(waiting.due(next + 2 * Waiting::kAgain - 1ms).empty()) << "twice as long each time";
  EXPECT_EQ(waiting.due(next + 2 * Waiting::kAgain).size(), 1u);
  waiting.proved(key);
  waiting.found(key, {}, next);
  EXPECT_TRUE(waiting.empty());
}

TEST(Unproven, AHandshakeThatFailsIsAllThatIsKnownAndIsForgotten) {
  Waiting waiting;
  const Waiting::Key key{1, 2, 3};
  const Waiting::Time begin{};
  waiting.refused(key, begin);
  EXPECT_TRUE(waiting.due(begin + Waiting::kNew - 1ms).empty()) << "the next one may do";
  waiting.refused(key, begin + 5s);
  const auto due = waiting.due(begin + Waiting::kNew);
  ASSERT_EQ(due.size(), 1u);
  EXPECT_TRUE(due.front().places.empty());
  (void)waiting.due(begin + 5s + Waiting::kForgotten);
  EXPECT_FALSE(waiting.empty());
  (void)waiting.due(begin + 5s + Waiting::kForgotten + 1ms);
  EXPECT_TRUE(waiting.empty());
}

TEST(Unproven, OneThatWasFoundIsNotForgottenAfterAHandshakeThatFails) {
  Waiting waiting;
  const Waiting::Key key{1, 2, 3};
  const Waiting::Time begin{};
  waiting.refused(key, begin);
  waiting.found(key, Waiting::Places(1), begin);
  waiting.refused(key, begin);
  EXPECT_EQ(waiting.due(begin + 2 * Waiting::kForgotten).at(0).places.size(), 1u);
}

TEST(Unproven, WhoWasKnownBeforeIsToldSoonerAndWhoHasSaidFarewellIsNot) {
  Waiting waiting;
  const Waiting::Time begin{};
  const auto first_word_after = [&](const Waiting::Key& key) {
    waiting.found(key, {}, begin);
    auto at = begin;
    while (waiting.due(at).empty()) at += 100ms;
    return at - begin;
  };
  for (const bool lapsed : {true, false}) {
    const Waiting::Key key{static_cast<std::uint8_t>(lapsed)};
    waiting.proved(key);
    waiting.gone(key, lapsed);
    EXPECT_EQ(first_word_after(key), lapsed ? Waiting::kKnownBefore : Waiting::kNew);
    waiting.gone(key, false);
    EXPECT_TRUE(waiting.empty());
  }
}

TEST(Reunion, EndsAlthoughSomebodyHasNotProvedWhoItIs) {
  bus::Reunion reunion([](const auto&) {});
  reunion.found({1, 2, 3}, {});
}

}  // namespace
}  // namespace telekerf
