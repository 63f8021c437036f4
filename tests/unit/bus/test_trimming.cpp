// SPDX-License-Identifier: Apache-2.0
// What is left out of a datagram, and that nothing else ever is.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "common/bus/trimming_transport.h"

namespace telekerf::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
Bytes part(std::uint8_t kind, Bytes body) {
  return Bytes{kind, 0x01, static_cast<std::uint8_t>(body.size()),
               static_cast<std::uint8_t>(body.size() >> 8)} +
         body;
}
Bytes what_is_sent(const Bytes& datagram) {
  const auto sent = trimmed(std::as_bytes(std::span(datagram)));
  Bytes bytes;
  for (const auto& span : {sent.head, sent.rest})
    for (const std::byte byte : span) bytes.push_back(std::to_integer<std::uint8_t>(byte));
  return bytes;
}

const Bytes kHead = Bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15} + Bytes(12, 0x6d);
const Bytes kDestination = part(0x0e, Bytes(12, 0x11));
const Bytes kTime = part(0x09, Bytes(8, 0x22));
const Bytes kStream = part(0x15, Bytes{0, 0, 16, 0, 0, 0, 0, 0, 0, 0x53, 0x10, 0x03} + Bytes(60, 0x33));
const Bytes kEvent = part(0x15, Bytes{0, 0, 16, 0, 0, 0, 0, 0, 0, 0x00, 0x10, 0x03} + Bytes(60, 0x33));
const Bytes kStatistics = part(0x80, Bytes(56, 0));
const Bytes kProtected = part(0x33, Bytes(20, 0x44));

TEST(Trimming, OfAStreamsSampleOnlyTheSampleIsLeft) {
  EXPECT_EQ(what_is_sent(kHead + kDestination + kTime + kStream + kStatistics), kHead + kStream);
  EXPECT_EQ(what_is_sent(kHead + kTime + kStream), kHead + kStream);
  EXPECT_EQ(what_is_sent(kHead + kStream), kHead + kStream);
}

TEST(Trimming, OfEverythingElseTheStatisticsAlone) {
  EXPECT_EQ(what_is_sent(kHead + kDestination + kTime + kEvent + kStatistics),
            kHead + kDestination + kTime + kEvent);
  EXPECT_EQ(what_is_sent(kHead + kEvent + kDestination + kTime + kStream + kStatistics),
            kHead + kEvent + kDestination + kTime + kStream)
      << "the address may be another's than the event's";
}

TEST(Trimming, OfAProtectedMessageWhatIsSignedStays) {
  EXPECT_EQ(what_is_sent(kHead + kProtected + kTime + kStream + kStatistics), kHead + kProtected + kTime + kStream);
  EXPECT_EQ(what_is_sent(kHead + kProtected + kDestination + kStream), kHead + kProtected + kDestination + kStream);
}

TEST(Trimming, WhatIsNotKnownForCertainStaysWhole) {
  const std::vector<Bytes> all = {kHead + kStatistics + kTime,
                                  kHead + kStatistics,
                                  kHead,
                                  {},
                                  {1, 2, 3},
                                  kHead + kTime + Bytes{0x15, 0x01, 0xff, 0x00, 1},
                                  Bytes(kHead.size(), 0) + kTime + kStream + kStatistics};
  for (const Bytes& datagram : all) EXPECT_EQ(what_is_sent(datagram), datagram);
}

TEST(Trimming, WhateverTheBytesNothingIsReadBeyondThem) {
  std::mt19937 random(1);
  const Bytes good = kHead + kDestination + kTime + kStream + kStatistics;
  for (int n = 0; n < 20000; ++n) {
    Bytes bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(random() % (good.size() + 1)));
    for (int flips = 0; flips < 3 && !bytes.empty(); ++flips)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    EXPECT_LE(what_is_sent(bytes).size(), bytes.size());
  }
}

}  // namespace
}  // namespace telekerf::bus
