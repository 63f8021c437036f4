// SPDX-License-Identifier: Apache-2.0
// What a secured participant lets in, whom it does not hear for a while, and to whom it says farewell so that
// a handshake begins anew.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstring>
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

TEST(Gate, LetsInWhatIsProtectedAndWhatComesBeforeKeysAndNothingElse) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}, {0x80, 9, 9, 9, 9, 9}});
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7},
      none{0x90, 1, 2, 3, 4, 6, 7, 7, 7, 7, 7, 7};
  const auto admits = [&](const std::vector<std::byte>& bytes) { return gate.admits(bytes, 1, 1); };
  const std::vector<std::uint8_t> secured{1, 2, 3, 4};
  EXPECT_TRUE(admits(datagram(ours, 0x33, secured)));
  EXPECT_FALSE(admits(datagram(none, 0x33, secured)));
  EXPECT_TRUE(admits(datagram(ours, 0x15, data_of(0x000100c2)))) << "an announcement";
  EXPECT_TRUE(admits(datagram(ours, 0x15, data_of(0x000201c3)))) << "a handshake";
  EXPECT_FALSE(admits(datagram(ours, 0x15, data_of(0x00531003)))) << "a block";
  EXPECT_FALSE(admits(datagram(ours, 0x15, data_of(0x000003c2)))) << "a writer's announcement in the clear";
  EXPECT_FALSE(admits(datagram(none, 0x15, data_of(0x000100c2))));
  EXPECT_FALSE(admits(datagram(ours, 0x0c, std::vector<std::uint8_t>(20, 0)))) << "speaks in another's name";
  auto hidden = datagram(ours, 0x09, std::vector<std::uint8_t>(8, 0));
  const auto behind = datagram(ours, 0x33, secured);
  hidden.insert(hidden.end(), behind.begin() + 20, behind.end());
  EXPECT_FALSE(admits(hidden)) << "protected, but not as a whole";
  EXPECT_FALSE(admits({}));
  EXPECT_FALSE(admits(std::vector<std::byte>(20)));
  EXPECT_EQ(gate.refused(), 8u);
}

TEST(Gate, OfEachIdentityOnlyAFewAreUnderWayUntilTheyProveIt) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  bus::Gate::Prefix prefix{0x90, 1, 2, 3, 4, 5};
  const auto announces = [&](std::uint8_t which, std::int64_t now_ns) {
    prefix[11] = which;
    return gate.admits(datagram(prefix, 0x15, data_of(0x000100c2)), 1, now_ns);
  };
  int admitted = 0;
  for (int i = 0; i < 100; ++i) admitted += announces(static_cast<std::uint8_t>(i), 1000) ? 1 : 0;
  EXPECT_EQ(admitted, static_cast<int>(bus::Gate::kUnproven));
  EXPECT_TRUE(announces(0, 1000));
  prefix[11] = 0;
  gate.proven(prefix);
  EXPECT_TRUE(announces(50, 1000)) << "its place is free";
  EXPECT_TRUE(announces(0, 1000));
  EXPECT_FALSE(announces(51, 1000));
  EXPECT_TRUE(announces(51, 1001 + bus::Gate::kForgotten_ns));
}

TEST(Gate, WhoSaysFarewellIsNotHeardUntilItsLeaseHasEnded) {
  bus::Gate gate({{0x90, 1, 2, 3, 4, 5}});
  const bus::Gate::Prefix ours{0x90, 1, 2, 3, 4, 5, 7, 7, 7, 7, 7, 7},
      another{0x90, 1, 2, 3, 4, 5, 8, 8, 8, 8, 8, 8}, to{1, 15};
  const auto announcement = datagram(ours, 0x15, data_of(0x000100c2));
  const auto of_a_stream = datagram(ours, 0x33, {1, 2, 3, 4});
  constexpr std::int64_t kBegin_ns = 1'000'000'000;
  EXPECT_TRUE(gate.admits(announcement, 1, kBegin_ns));
  EXPECT_FALSE(gate.admits(bus::farewell(ours, to), 1, kBegin_ns)) << "it is not passed on";
  const std::int64_t end_ns = kBegin_ns + bus::Gate::kDeaf_ns;
  for (const std::int64_t now_ns : {kBegin_ns, end_ns - 1}) {
    EXPECT_FALSE(gate.admits(announcement, 1, now_ns));
    EXPECT_FALSE(gate.admits(of_a_stream, 1, now_ns)) << "its keys count no more";
    EXPECT_TRUE(gate.admits(datagram(another, 0x33, {1, 2, 3, 4}), 1, now_ns)) << "its next start";
  }
  EXPECT_TRUE(gate.admits(announcement, 1, end_ns));
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
