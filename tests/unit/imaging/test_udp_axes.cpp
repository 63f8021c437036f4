// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <thread>

#include "common/runtime/startup_error.h"
#include "slave/vision/imaging/udp_axes.h"

namespace telekerf::imaging {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

/// The other end, datagram by datagram.
class UdpAxesTest : public ::testing::Test {
 protected:
  UdpAxesTest() : socket_(context_, udp::endpoint(asio::ip::address_v4::loopback(), 0)) {
    axes_ = std::make_unique<UdpAxes>(UdpAddress{"127.0.0.1", socket_.local_endpoint().port()}, 1e-3);
  }
  UdpAxesCurrents hear() {
    UdpAxesCurrents currents;
    EXPECT_EQ(socket_.receive_from(asio::buffer(&currents, sizeof(currents)), controller_), sizeof(currents));
    return currents;
  }
  void answer(const UdpAxesReading& reading, std::size_t size = sizeof(UdpAxesReading)) {
    socket_.send_to(asio::buffer(&reading, size), controller_);
  }
  /// What the controller reads, at the latest after half a second.
  AxesReading read() {
    AxesReading reading;
    for (int i = 0; i < 500 && !reading.valid; ++i) {
      reading = axes_->read();
      if (!reading.valid) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return reading;
  }
  static UdpAxesReading reading_for(std::uint64_t sequence) {
    UdpAxesReading reading;
    reading.valid = 1;
    reading.sequence = sequence;
    reading.tick = 70 + sequence;
    reading.encoders_m[kMagnification] = 0.01;
    reading.encoders_m[kFocus] = -0.002;
    reading.at_lower_end[kFocus] = 1;
    return reading;
  }

  asio::io_context context_;
  udp::socket socket_;
  udp::endpoint controller_;
  std::unique_ptr<UdpAxes> axes_;
};

TEST_F(UdpAxesTest, CurrentsGoOutAsDocumented) {
  axes_->write({1.5, -0.25});
  axes_->write({0.5, 0.75});
  std::array<unsigned char, 64> bytes{};
  EXPECT_EQ(socket_.receive_from(asio::buffer(bytes), controller_), 32U);
  EXPECT_EQ(std::memcmp(bytes.data(), "TKIC", 4), 0);
  UdpAxesCurrents first;
  std::memcpy(&first, bytes.data(), sizeof(first));
  EXPECT_EQ(first.period_ns, 1'000'000U);
  EXPECT_EQ(first.sequence, 1U);
  EXPECT_EQ(first.currents_a[kMagnification], 1.5);
  EXPECT_EQ(first.currents_a[kFocus], -0.25);
  const UdpAxesCurrents second = hear();
  EXPECT_EQ(second.sequence, 2U);
  EXPECT_EQ(second.currents_a[kFocus], 0.75);
}

TEST_F(UdpAxesTest, AnAnswerIsAReading) {
  axes_->write({});
  hear();
  answer(reading_for(1));
  const AxesReading reading = read();
  ASSERT_TRUE(reading.valid);
  EXPECT_EQ(reading.tick, 71U);
  EXPECT_EQ(reading.encoders_m, (PerAxis{0.01, -0.002}));
  EXPECT_EQ(reading.at_lower_end, (std::array<bool, kAxes>{false, true}));
  EXPECT_FALSE(axes_->read().valid);  // once
}

TEST_F(UdpAxesTest, AnAnswerThatComesTooLateIsNone) {
  for (std::uint64_t late = 0; late < 5; ++late) {
    SCOPED_TRACE(late);
    axes_->write({});
    const std::uint64_t asked = hear().sequence;
    for (std::uint64_t i = 0; i < late; ++i) axes_->write({});
    for (std::uint64_t i = 0; i < late; ++i) hear();
    answer(reading_for(asked));
    AxesReading reading;
    for (int i = 0; i < 500 && reading.tick == 0; ++i) {
      reading = axes_->read();
      if (reading.tick == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_EQ(reading.tick, 70U + asked);
    EXPECT_EQ(reading.valid, late <= 2);
  }
}

TEST_F(UdpAxesTest, ALookTakesSixtyFourDatagramsAndLeavesTheRestToTheNext) {
  for (int i = 0; i < 70; ++i) axes_->write({});
  for (int i = 0; i < 70; ++i) hear();
  for (std::uint64_t sequence = 1; sequence <= 70; ++sequence) answer(reading_for(sequence));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(axes_->read().tick, 70U + 64U);
  EXPECT_EQ(axes_->read().tick, 70U + 70U);
}

TEST_F(UdpAxesTest, WhatIsNoAnswerIsDropped) {
  axes_->write({});
  hear();
  UdpAxesReading wrong = reading_for(1);
  wrong.magic = UdpAxesCurrents::kMagic;
  answer(wrong);
  answer(reading_for(1), sizeof(UdpAxesReading) - 1);
  udp::socket stranger(context_, udp::endpoint(asio::ip::address_v4::loopback(), 0));
  const UdpAxesReading forged = reading_for(1);
  stranger.send_to(asio::buffer(&forged, sizeof(forged)), controller_);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(axes_->read().valid);
  EXPECT_EQ(axes_->dropped(), 3U);
}

TEST_F(UdpAxesTest, OvertakenAndUnaskedAnswersAreLeftAlone) {
  axes_->write({});
  axes_->write({});
  hear();
  hear();
  answer(reading_for(3));  // was never asked
  answer(reading_for(2));
  ASSERT_TRUE(read().valid);
  answer(reading_for(1));
  answer(reading_for(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(axes_->read().valid);
}

TEST_F(UdpAxesTest, PositionsThatAreNoNumbersAreInvalid) {
  axes_->write({});
  hear();
  UdpAxesReading reading = reading_for(1);
  reading.encoders_m[kFocus] = std::nan("");
  answer(reading);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(axes_->read().valid);
  axes_->write({});
  hear();
  reading = reading_for(2);
  reading.valid = 2;
  answer(reading);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(axes_->read().valid);
}

TEST(UdpAxes, RefusesAnAddressThatIsNone) {
  EXPECT_THROW(UdpAxes({"no.such.host.invalid", 7000}, 1e-3), StartupError);
}

}  // namespace
}  // namespace telekerf::imaging
