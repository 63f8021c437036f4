// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "netem/drivers/datagram.h"

namespace telekerf::netem {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, std::initializer_list<int> values) {
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
}

/// RTPS header of a participant at the slave's site.
Bytes header() {
  Bytes bytes;
  append(bytes, {'R', 'T', 'P', 'S', 2, 3, 1, 15});
  append(bytes, {1, 15, 0x73, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  return bytes;
}

void append_timestamp(Bytes& bytes) { append(bytes, {0x09, 1, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0}); }

/// DATA submessage, little endian, 8 octets of payload.
void append_data(Bytes& bytes, int entity, int flags = 0x05) {
  append(bytes, {0x15, flags, 28, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, entity, 1, 3, 0, 0, 0, 0, 1, 0, 0, 0});
  append(bytes, {0, 1, 0, 0, 1, 2, 3, 4});
}

TEST(Datagram, NamesTheSite) {
  EXPECT_EQ(site_of(header(), {}), Site::kSlave);
  Bytes other = header();
  other[3] = std::byte{'X'};
  EXPECT_FALSE(site_of(other, {}));
  EXPECT_FALSE(site_of(Bytes(19), {}));
}

TEST(Datagram, NamesTheSiteByATableWhereThereIsOne) {
  const SiteTable sites({{{1, 15, 0x73, 4, 5, 6}, Site::kOperator}, {{1, 15, 0x73, 4, 5, 7}, Site::kSlave}});
  EXPECT_EQ(site_of(header(), sites), Site::kOperator) << "whatever its third byte says";
  Bytes other = header();
  other[13] = std::byte{7};
  EXPECT_EQ(site_of(other, sites), Site::kSlave);
  other[13] = std::byte{8};
  EXPECT_FALSE(site_of(other, sites));
}

TEST(Datagram, FindsAStreamsPayload) {
  Bytes bytes = header();
  append_timestamp(bytes);
  append_data(bytes, kStreamEntity);
  const Range range = stream_payload(bytes);
  EXPECT_EQ(range.begin, 20 + 12 + 24);
  EXPECT_EQ(range.end, bytes.size());
}

TEST(Datagram, HasNoPayloadThatDamageMayBeFoundInWhereItIsProtected) {
  Bytes bytes = header();
  append(bytes, {0x33, 1, 4, 0, 1, 2, 3, 4});
  append_data(bytes, kStreamEntity);
  const Range range = stream_payload(bytes);
  EXPECT_EQ(range.begin, range.end);
}

/// The bytes of one DATA submessage behind the header, one of them changed.
Range with(std::size_t at, int value) {
  Bytes bytes = header();
  append_data(bytes, kStreamEntity);
  bytes[20 + at] = static_cast<std::byte>(value);
  return stream_payload(bytes);
}

TEST(Datagram, SubmessagesEndWhereTheySay) {
  const auto found = [](const Range& range) { return range.end - range.begin; };
  EXPECT_EQ(found(with(0, 0x15)), 8);
  EXPECT_EQ(found(with(0, 0x16)), 0) << "no DATA";
  EXPECT_EQ(found(with(1, 0x01)), 0) << "no payload";
  EXPECT_EQ(found(with(2, 0)), 8) << "a length of nothing: to the end";
  EXPECT_EQ(found(with(2, 27)), 7);
  EXPECT_EQ(found(with(2, 20)), 0) << "a payload of nothing";
  EXPECT_EQ(found(with(2, 29)), 0) << "beyond the datagram";
  EXPECT_EQ(found(with(2, 19)), 0) << "too short for a writer's DATA";
  EXPECT_EQ(found(with(12, 1)), 0) << "another writer";
  EXPECT_EQ(found(with(13, kStreamEntity + 1)), 0);
  Bytes big_endian = header();
  append(big_endian, {0x15, 0x04, 0, 28});
  const Bytes body(28);
  big_endian.insert(big_endian.end(), body.begin(), body.end());
  big_endian[20 + 13] = static_cast<std::byte>(kStreamEntity);
  EXPECT_EQ(found(stream_payload(big_endian)), 8);
  Bytes second = header();
  append_data(second, 0);
  append_data(second, kStreamEntity);
  EXPECT_EQ(stream_payload(second).begin, 20 + 32 + 24);
  EXPECT_EQ(found(stream_payload(Bytes(65536))), 0);
}

TEST(Datagram, OtherWritersHaveNone) {
  Bytes counted = header();
  append_data(counted, 0);
  EXPECT_EQ(stream_payload(counted).begin, stream_payload(counted).end);
  Bytes inline_qos = header();
  append_data(inline_qos, kStreamEntity, 0x07);
  EXPECT_EQ(stream_payload(inline_qos).end, 0);
}

TEST(Datagram, EveryFlippedBitOutsideShows) {
  Bytes bytes = header();
  append_timestamp(bytes);
  append_data(bytes, kStreamEntity);
  const Range range = stream_payload(bytes);
  const std::uint8_t parity = parity_outside(bytes, range);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    Bytes damaged = bytes;
    damaged[bit / 8] ^= std::byte{1} << (bit % 8);
    const bool inside = bit / 8 >= range.begin && bit / 8 < range.end;
    EXPECT_EQ(parity_outside(damaged, range) == parity, inside) << "bit " << bit;
  }
}

TEST(Datagram, AnyBytesStayInBounds) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = header();
    const std::size_t size = random() % 120;
    for (std::size_t n = 0; n < size; ++n)
      bytes.push_back(static_cast<std::byte>(random() % 4 == 0 ? 0x15 : random()));
    const Range range = stream_payload(bytes);
    ASSERT_LE(range.begin, range.end);
    ASSERT_LE(range.end, bytes.size());
    (void)parity_outside(bytes, range);
  }
}

}  // namespace
}  // namespace telekerf::netem
