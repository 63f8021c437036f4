// SPDX-License-Identifier: Apache-2.0
// The seal of a device's datagrams: what is changed, recorded or made with another key is not opened.
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/runtime/datagram_seal.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/udp.h"

namespace telekerf {
namespace {

struct Told {
  std::uint64_t sequence = 0;
  double value = 0.0;
};

class Seal : public testing::Test {
 protected:
  static std::string key_file(const std::string& digits, unsigned mode = 0600) {
    static int count = 0;
    const auto file = std::filesystem::path(testing::TempDir()) /
                      ("telekerf-seal-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::ofstream(file) << digits << '\n';
    std::filesystem::permissions(file, std::filesystem::perms(mode));
    return file.string();
  }
  const std::string digits_ = std::string(62, 'a') + "07";
  DatagramSeal seal_{key_file(digits_)};
};

TEST_F(Seal, IsTheFirstOctetsOfAnHmacOverDatagramAndTime) {
  DatagramSeal::Sealed<Told> sealed{{7, 1.5}};
  const std::size_t size = seal_.close(sealed);
  ASSERT_EQ(size, sizeof(Told) + 16);
  std::vector<unsigned char> key(31, 0xaa);
  key.push_back(0x07);
  unsigned char mac[32];
  unsigned length = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(&sealed), sizeof(Told) + 8, mac, &length);
  EXPECT_EQ(std::memcmp(mac, sealed.seal.data() + 8, 8), 0);
  EXPECT_EQ(seal_.open(sealed, size), sizeof(Told));
}

TEST_F(Seal, NoChangedOctetIsOpened) {
  DatagramSeal::Sealed<Told> sealed{{7, 1.5}};
  const std::size_t size = seal_.close(sealed);
  const auto bytes = std::as_writable_bytes(std::span(&sealed, 1));
  for (std::size_t i = 0; i < size; ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] ^= std::byte(1 << bit);
      EXPECT_EQ(seal_.open(sealed, size), 0u) << i;
      bytes[i] ^= std::byte(1 << bit);
    }
  }
  for (std::size_t shorter = 0; shorter < size; ++shorter) EXPECT_EQ(seal_.open(sealed, shorter), 0u);
  Arrival<DatagramSeal::Sealed<Told>> longer{sealed};
  EXPECT_EQ(longer.room().size(), size + 1);
  EXPECT_EQ(seal_.open(longer.datagram, longer.room().size()), 0u) << "sealed well, and something behind it";
  DatagramSeal other{key_file(std::string(64, 'b'))};
  EXPECT_EQ(other.open(sealed, size), 0u);
  EXPECT_EQ(DatagramSeal().open(sealed, size), size) << "without a key it is a datagram of another size";
}

TEST_F(Seal, TenThousandGuessesOpenNothing) {
  std::mt19937_64 random(1);
  DatagramSeal::Sealed<Told> sealed{{7, 1.5}};
  const std::size_t size = seal_.close(sealed);
  for (int i = 0; i < 10000; ++i) {
    ++sealed.datagram.sequence;
    const std::uint64_t guess = random();
    std::memcpy(sealed.seal.data() + 8, &guess, sizeof guess);
    ASSERT_EQ(seal_.open(sealed, size), 0u);
  }
}

/// The datagram as if it had been sealed that much later, with its right code.
DatagramSeal::Sealed<Told> sealed_later(DatagramSeal::Sealed<Told> sealed, std::int64_t later_ns) {
  std::vector<unsigned char> key(31, 0xaa);
  key.push_back(0x07);
  std::int64_t sent_ns = 0;
  std::memcpy(&sent_ns, sealed.seal.data(), sizeof sent_ns);
  sent_ns += later_ns;
  std::memcpy(sealed.seal.data(), &sent_ns, sizeof sent_ns);
  unsigned char mac[32];
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(&sealed), sizeof(Told) + 8, mac, nullptr);
  std::memcpy(sealed.seal.data() + 8, mac, 8);
  return sealed;
}

TEST_F(Seal, WhatIsFromAnotherTimeIsNotOpened) {
  const std::string file = key_file(digits_);
  for (const auto& [later_ns, good] : {std::pair<std::int64_t, bool>{0, true},
                                       {1'500'000'000, true},
                                       {2'500'000'000, false},
                                       {-1'500'000'000, false},  // from before the receiver was there
                                       {-2'500'000'000, false}}) {
    DatagramSeal receiver(file);
    DatagramSeal::Sealed<Told> sealed{{7, 1.5}};
    const std::size_t size = seal_.close(sealed);
    EXPECT_EQ(receiver.open(sealed_later(sealed, later_ns), size), good ? sizeof(Told) : 0u) << later_ns;
  }
}

TEST_F(Seal, NothingIsOpenedTwiceNorAfterWhatWasSealedLater) {
  DatagramSeal::Sealed<Told> first{{7, 1.5}}, second{{1, 0.5}};
  const std::size_t size = seal_.close(first);
  (void)seal_.close(second);
  EXPECT_EQ(seal_.open(first, size), sizeof(Told));
  EXPECT_EQ(seal_.open(first, size), 0u) << "recorded and sent again";
  EXPECT_EQ(seal_.open(second, size), sizeof(Told)) << "whatever its number: that is the datagram's affair";
  EXPECT_EQ(seal_.open(first, size), 0u);
  EXPECT_EQ(seal_.open(second, size), 0u);
}

TEST_F(Seal, AKeyFileMustBeOneAndPrivate) {
  EXPECT_THROW(DatagramSeal("/nowhere/device.key"), StartupError);
  EXPECT_THROW(DatagramSeal(key_file("abc")), StartupError);
  EXPECT_THROW(DatagramSeal(key_file(std::string(63, 'a') + "x")), StartupError);
  EXPECT_THROW(DatagramSeal(key_file(digits_, 0644)), StartupError);
}

TEST_F(Seal, AnAddressNamesItsKeyWhereTheDeviceKnowsSeals) {
  const UdpAddress address = udp_address("127.0.0.1:7000,key=/a/b,c.key");
  EXPECT_EQ(address.host, "127.0.0.1");
  EXPECT_EQ(address.port, 7000);
  EXPECT_EQ(address.key, "/a/b,c.key");
  EXPECT_TRUE(udp_address("127.0.0.1:7000").key.empty());
  EXPECT_EQ(validate_sealed_udp("h:1,key=k"), "");
  EXPECT_NE(validate_sealed_udp("h:1,key="), "");
  EXPECT_NE(validate_udp("h:1,key=k"), "");
}

}  // namespace
}  // namespace telekerf
