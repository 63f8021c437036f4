// SPDX-License-Identifier: Apache-2.0
// The laser button from a device: letting go is the answer to every doubt.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "common/runtime/startup_error.h"
#include "master/operator/udp_foot_switch.h"
#include "tests/unit/allocations.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::string refusal_of(const std::string& button) {
  try {
    (void)open_operator_input(button);
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(Button, WhatIsNoneIsRefusedWithWhatItMustBe) {
  for (const char* wrong : {"", "Hand", "held", "usb:1"}) {
    EXPECT_NE(validate_operator_input(wrong).find("must be one of hand, pressed, udp:HOST:PORT"),
              std::string::npos)
        << wrong;
  }
  EXPECT_EQ(validate_operator_input("pressed:1"), "stands alone, nothing follows its name");
  EXPECT_NE(validate_operator_input("udp:7300").find("within [1, 65535]"), std::string::npos);
  EXPECT_EQ(open_operator_input("hand"), nullptr) << "the simulated one's";
  EXPECT_TRUE(open_operator_input("pressed")->sample(0).trigger);
  const UdpFootSwitch there({"127.0.0.1", 0});
  const std::string taken = "udp:127.0.0.1:" + std::to_string(there.port());
  EXPECT_EQ(refusal_of(taken), "button = " + taken +
                                   ": Address already in use; give an address of this host, and a port that "
                                   "is free");
  EXPECT_NE(refusal_of("udp:192.0.2.1:7300").find("give an address of this host"), std::string::npos);
}

class Pedal : public ::testing::Test {
 protected:
  using Socket = boost::asio::ip::udp::socket;
  void tell(Socket& from, std::uint64_t sequence, std::uint32_t held, std::uint32_t version = 1) {
    UdpButton told;
    told.version = version;
    told.sequence = sequence;
    told.held = held;
    from.send_to(boost::asio::buffer(&told, sizeof(told)),
                 {boost::asio::ip::address_v4::loopback(), pedal.port()});
  }
  void tell(std::uint64_t sequence, std::uint32_t held) { tell(foot, sequence, held); }
  bool pressed() { return pedal.sample(now_ns).trigger; }

  UdpFootSwitch pedal{{"127.0.0.1", 0}};
  boost::asio::io_context context;
  Socket foot{context, {boost::asio::ip::address_v4::loopback(), 0}};
  Socket stranger{context, {boost::asio::ip::address_v4::loopback(), 0}};
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(Pedal, IsHeldAsLongAsItSaysSo) {
  EXPECT_FALSE(pressed());
  tell(1, 0);
  EXPECT_FALSE(pressed());
  tell(2, 1);
  const auto before = testing::allocations();
  EXPECT_TRUE(pressed());
  EXPECT_EQ(testing::allocations(), before);
  tell(3, 0);
  EXPECT_FALSE(pressed());
  tell(4, 1);
  tell(5, 0);
  EXPECT_FALSE(pressed()) << "the newest counts";
  tell(6, 3);
  EXPECT_FALSE(pressed());
}

TEST_F(Pedal, SilenceIsLettingGoAndItMustBePressedAnew) {
  tell(1, 0);
  tell(2, 1);
  EXPECT_TRUE(pressed());
  now_ns += OperatorLease::kSilence_ns - 1;
  EXPECT_TRUE(pressed());
  ++now_ns;
  EXPECT_FALSE(pressed());
  for (std::uint64_t sequence = 3; sequence < 10; ++sequence, now_ns += 50 * kMs) {
    tell(sequence, 1);
    EXPECT_FALSE(pressed()) << "held down while the line came back";
  }
  tell(10, 0);
  tell(11, 1);
  EXPECT_TRUE(pressed());
}

TEST_F(Pedal, SqueezedInFrightItStopsAndHasToBeLetGoBeforeItIsHeldAgain) {
  tell(1, 0);
  tell(2, UdpButton::kHeld);
  OperatorSample told = pedal.sample(now_ns);
  EXPECT_TRUE(told.trigger && !told.stop);
  tell(3, UdpButton::kSqueezed);
  for (int n = 0; n < 3; ++n) {
    told = pedal.sample(now_ns += kMs);
    EXPECT_TRUE(told.stop && !told.trigger) << n;
  }
  tell(4, UdpButton::kHeld);
  told = pedal.sample(now_ns);
  EXPECT_FALSE(told.stop) << "the stop has been said";
  EXPECT_FALSE(told.trigger) << "on the way back from the squeeze";
  tell(5, 0);
  tell(6, UdpButton::kHeld);
  EXPECT_TRUE(pressed());
  tell(7, UdpButton::kSqueezed);
  tell(8, 0);
  EXPECT_TRUE(pedal.sample(now_ns).stop) << "for less than a step";
  EXPECT_FALSE(pedal.sample(now_ns).stop);
}

TEST_F(Pedal, ASqueezedOneThatFallsSilentOrIsAStrangersWantsNoStop) {
  tell(1, UdpButton::kSqueezed);
  EXPECT_TRUE(pedal.sample(now_ns).stop) << "nobody has to have let go for that";
  now_ns += OperatorLease::kSilence_ns;
  EXPECT_FALSE(pedal.sample(now_ns).stop) << "what it said is latched elsewhere";
  tell(2, 0);
  EXPECT_FALSE(pedal.sample(now_ns).stop);
  tell(stranger, 3, UdpButton::kSqueezed);
  tell(2, UdpButton::kSqueezed);
  EXPECT_FALSE(pedal.sample(now_ns).stop);
}

TEST_F(Pedal, WhatIsNotItsOwnIsCounted) {
  tell(1, 0);
  tell(2, 1);
  EXPECT_TRUE(pressed());
  EXPECT_EQ(pedal.refused(), 0u);
  const boost::asio::ip::udp::endpoint there{boost::asio::ip::address_v4::loopback(), pedal.port()};
  for (const std::size_t size : {0u, 8u, 23u, 25u, 40u, 41u, 60000u}) {
    UdpButton squeezed;
    squeezed.sequence = 100 + size;
    squeezed.held = UdpButton::kSqueezed;
    std::vector<char> bytes(std::max(size, sizeof squeezed));
    std::memcpy(bytes.data(), &squeezed, sizeof squeezed);
    foot.send_to(boost::asio::buffer(bytes.data(), size), there);
    EXPECT_FALSE(pedal.sample(now_ns).stop) << size;
  }
  EXPECT_EQ(pedal.refused(), 7u);
  tell(stranger, 200, 1);
  tell(foot, 201, 1, 2);
  tell(2, 0);  // overtaken on the way
  EXPECT_TRUE(pressed());
  EXPECT_EQ(pedal.refused(), 9u);
}

TEST(SealedPedal, ALongerDatagramIsRefused) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("telekerf-pedal-key-" + std::to_string(::getpid()));
  std::ofstream(file) << std::string(64, 'a') << '\n';
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  UdpFootSwitch pedal({"127.0.0.1", 0, file.string()});
  const DatagramSeal seal(file.string());
  boost::asio::io_context context;
  boost::asio::ip::udp::socket foot(context, {boost::asio::ip::address_v4::loopback(), 0});
  std::uint64_t sequence = 0;
  const auto stops = [&](std::size_t more) {
    Arrival<DatagramSeal::Sealed<UdpButton>> told{};
    told.datagram.datagram.sequence = ++sequence;
    told.datagram.datagram.held = UdpButton::kSqueezed;
    const std::size_t size = seal.close(told.datagram);
    foot.send_to(boost::asio::buffer(&told, size + more),
                 {boost::asio::ip::address_v4::loopback(), pedal.port()});
    return pedal.sample(1000 * kMs).stop;
  };
  EXPECT_FALSE(stops(1));
  EXPECT_EQ(pedal.refused(), 1u);
  EXPECT_TRUE(stops(0));
  EXPECT_EQ(pedal.refused(), 1u);
  std::filesystem::remove(file);
}

TEST_F(Pedal, HeldDownFromTheStartIsNotPressed) {
  tell(1, 1);
  EXPECT_FALSE(pressed());
}

TEST_F(Pedal, AnOldDatagramAndAStrangersHoldNothing) {
  tell(1, 0);
  tell(5, 1);
  EXPECT_TRUE(pressed());
  now_ns += 99 * kMs;
  tell(4, 1);
  tell(5, 1);
  tell(stranger, 100, 1);
  tell(foot, 101, 1, 2);
  boost::asio::ip::udp::endpoint there{boost::asio::ip::address_v4::loopback(), pedal.port()};
  foot.send_to(boost::asio::buffer("hold"), there);
  EXPECT_TRUE(pressed());
  now_ns += kMs;
  EXPECT_FALSE(pressed()) << "none of them was an answer";
  tell(stranger, 1, 0);
  tell(stranger, 2, 1);
  EXPECT_TRUE(pressed()) << "after a silence another pedal may speak, or the same one that began anew";
}

}  // namespace
}  // namespace telekerf::master
