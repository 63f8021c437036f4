// SPDX-License-Identifier: Apache-2.0
// The laser behind a UDP address: what it is told, and what one at the other end makes of it.
#include <gtest/gtest.h>

#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <type_traits>
#include <utility>

#include "slave/laser/laser_output.h"
#include "tests/unit/allocations.h"
#include "tests/unit/laser/laser_device.h"
#include "tests/unit/laser/permits.h"

namespace telekerf::laser {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What a laser takes for the time.
std::int64_t clock_ns = 0;
std::int64_t test_clock() noexcept { return clock_ns; }

TEST(UdpLaser, TellsEachStepAndAllocatesNothing) {
  EXPECT_EQ(UdpPower{}.magic, 0x4c554b54u);
  EXPECT_EQ(UdpPower{}.version, 2u);
  EXPECT_EQ(UdpPower{}.sequence, 0u);
  EXPECT_EQ(UdpPower{}.power_w, 0.0);
  EXPECT_EQ(UdpPower{}.period_ns, 0u);
  EXPECT_EQ(UdpPower{}.pilot, 0u);
  LaserSocket socket;
  UdpLaser laser(socket.address(), 2400.0, test_clock);
  std::uint64_t sequence = 0;
  while (const auto arrival = socket.take()) {
    EXPECT_EQ(arrival->told.power_w, 0.0) << "off at first";
    EXPECT_GT(arrival->told.sequence, sequence);
    sequence = arrival->told.sequence;
  }
  EXPECT_EQ(sequence, 2u) << "a second time, to hear what became of the first";
  const auto before = testing::allocations();
  bool told = true;
  for (int n = 0; n < 100; ++n) {
    told = laser.emit({0.1 * n, n % 2 == 1, 500'000 + n, static_cast<std::uint64_t>(n)}) && told;
    told = !laser.stray() && told;
  }
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(told);
  for (int n = 0; n < 100; ++n) {
    const auto arrival = socket.take();
    ASSERT_TRUE(arrival.has_value()) << n;
    EXPECT_EQ(arrival->size, 48u);
    EXPECT_EQ(arrival->told.magic, UdpPower::kMagic);
    EXPECT_EQ(arrival->told.version, 2u);
    EXPECT_EQ(arrival->told.sequence, ++sequence);
    EXPECT_EQ(arrival->told.power_w, 0.1 * n);
    EXPECT_EQ(arrival->told.pilot, n % 2);
    EXPECT_EQ(arrival->told.period_ns, 416667u);
    EXPECT_EQ(arrival->told.lasts_ns, 500'000u + static_cast<unsigned>(n));
    EXPECT_EQ(arrival->told.enable, static_cast<std::uint64_t>(n));
  }
}

TEST(UdpLaser, WhereNobodyListensIsRefused) {
  std::string laser;
  {
    const LaserSocket closed;
    laser = closed.laser();
  }
  EXPECT_EQ(
      refusal_of(stated(laser), 10.0),
      "laser = " + laser + ": Connection refused; is the laser switched on, connected, and its port right?");
}

TEST(UdpLaser, ThatGoesAwayIsLost) {
  auto socket = std::make_unique<LaserSocket>();
  Permitted beam(stated(socket->laser()), 10.0, 1000.0);
  for (int n = 0; n < 10; ++n) beam.emit(1.0, false);
  EXPECT_EQ(beam.output.write_failures(), 0u);
  socket.reset();
  for (int n = 0; n < 10; ++n) beam.emit(1.0, false);
  EXPECT_TRUE(beam.output.failed());
}

TEST(UdpLaser, IsToldAnewInTheSameStepWhenTheDatagramBeforeFailed) {
  auto socket = std::make_unique<LaserSocket>();
  const unsigned short port = socket->address().port;
  UdpLaser laser(socket->address(), 1000.0, test_clock);
  socket.reset();
  EXPECT_TRUE(laser.emit({1.0, false, 0, 0})) << "nobody has answered yet";
  LaserSocket again(port);
  EXPECT_FALSE(laser.emit({2.0, true, 0, 0}));
  const auto arrival = again.take();
  ASSERT_TRUE(arrival.has_value());
  EXPECT_EQ(arrival->told.power_w, 2.0);
  EXPECT_EQ(arrival->told.pilot, 1u);
  EXPECT_TRUE(laser.emit({3.0, false, 0, 0}));
}

TEST(UdpLaser, SaysOffWhereAStepWasHeldUpLongerThanTheLaserWaits) {
  LaserSocket socket;
  UdpLaser laser(socket.address(), 1000.0, test_clock);
  const auto told = [&](std::int64_t later_ns) {
    while (socket.take()) {
    }
    clock_ns += later_ns;
    EXPECT_TRUE(laser.emit({5.0, true, 2'000'000, 1}));
    return socket.take().value_or(LaserSocket::Arrival{}).told;
  };
  EXPECT_EQ(told(1'000'000).power_w, 5.0);
  EXPECT_EQ(told(3'000'000).power_w, 5.0);
  const UdpPower late = told(3'000'001);
  EXPECT_EQ(late.power_w, 0.0);
  EXPECT_EQ(late.pilot, 0u);
  EXPECT_EQ(told(1'000'000).power_w, 5.0) << "the next steps are the interlock's affair";
}

TEST(UdpLaser, LightIsNeverToLastLongerThanTwoPeriodsNorLessThanNoTime) {
  LaserSocket socket;
  UdpLaser laser(socket.address(), 1000.0, test_clock);
  for (const auto& [asked_ns, told_ns] : {std::pair{std::int64_t{-1}, 0U},
                                          {0, 0U},
                                          {1, 1U},
                                          {2'000'000, 2'000'000U},
                                          {2'000'001, 2'000'000U},
                                          {5'000'000'000, 2'000'000U}}) {
    while (socket.take()) {
    }
    EXPECT_TRUE(laser.emit({5.0, false, asked_ns, 1}));
    EXPECT_EQ(socket.take().value_or(LaserSocket::Arrival{}).told.lasts_ns, told_ns) << asked_ns;
  }
}

TEST(UdpLaser, MayBeSilentForThreeMillisecondsOrTwoPeriods) {
  for (const auto& [period_ns, silence_ns] : {std::pair{0U, 3'000'000},
                                              {1'000'000U, 3'000'000},
                                              {1'500'000U, 3'000'000},
                                              {1'500'001U, 3'000'002},
                                              {5'000'000U, 10'000'000}}) {
    EXPECT_EQ(udp_silence_ns(period_ns), silence_ns) << period_ns;
  }
  EXPECT_EQ(udp_silence_ns(4'000'000'000U), 8'000'000'000) << "beyond 32 bits";
}

constexpr std::int64_t kMs = 1'000'000;

class Device : public ::testing::Test {
 protected:
  bool tell(std::uint64_t sequence, double power_w, unsigned short from = 1) {
    UdpPower told;
    told.sequence = sequence;
    told.power_w = power_w;
    told.period_ns = period_ns;
    told.lasts_ns = lasts_ns;
    told.enable = enable++;
    return device.hear(told, sizeof(told), {boost::asio::ip::address_v4::loopback(), from}, now_ns);
  }
  double power_w() const { return device.power_w(now_ns); }

  UdpLaserDevice device{20.0};
  std::uint32_t period_ns = kMs;
  std::uint32_t lasts_ns = 20 * kMs;
  std::uint64_t enable = 1;
  std::int64_t now_ns = 0;
};

TEST_F(Device, IsOffAfterSilence) {
  EXPECT_EQ(power_w(), 0.0);
  EXPECT_TRUE(tell(1, 0.0));
  EXPECT_TRUE(tell(2, 8.0));
  EXPECT_EQ(power_w(), 8.0);
  now_ns += 3 * kMs - 1;
  EXPECT_EQ(power_w(), 8.0);
  ++now_ns;
  EXPECT_EQ(power_w(), 0.0);
  EXPECT_TRUE(tell(3, 8.0)) << "the same controller was only late";
  EXPECT_EQ(power_w(), 8.0);
  period_ns = 5 * kMs;
  EXPECT_TRUE(tell(4, 8.0));
  now_ns += 9 * kMs;
  EXPECT_EQ(power_w(), 8.0);
  now_ns += kMs;
  EXPECT_EQ(power_w(), 0.0);
}

TEST_F(Device, IsNotKeptOnByAnOldDatagram) {
  tell(1, 0.0);
  tell(5, 8.0);
  for (int n = 0; n < 3; ++n, now_ns += kMs) EXPECT_FALSE(tell(n == 0 ? 5 : 4, 8.0));
  EXPECT_EQ(power_w(), 0.0);
  tell(6, 0.0);
  EXPECT_FALSE(tell(5, 8.0)) << "overtaken by the beam's end";
  EXPECT_EQ(power_w(), 0.0);
}

TEST_F(Device, ObeysOneControllerAndANewOneOnlyFromItsFirstOff) {
  now_ns = 10'000 * kMs;  // a clock that does not begin with it
  EXPECT_FALSE(tell(1, 8.0)) << "off comes first";
  tell(1, 0.0);
  tell(2, 8.0);
  EXPECT_FALSE(tell(100, 8.0, 2));
  EXPECT_FALSE(tell(100, 0.0, 2));
  now_ns += 500 * kMs;
  EXPECT_FALSE(tell(100, 8.0, 2));
  EXPECT_TRUE(tell(1, 0.0, 2));
  EXPECT_TRUE(tell(2, 8.0, 2));
  EXPECT_FALSE(tell(3, 8.0, 1));
}

TEST_F(Device, GivesNeverMoreThanItHasAndNothingThatIsNoPower) {
  tell(1, 0.0);
  tell(2, 50.0);
  EXPECT_EQ(power_w(), 20.0);
  for (const double wrong : {-1.0, kNan, kInfinite}) EXPECT_FALSE(tell(3, wrong)) << wrong;
}

TEST_F(Device, IsOffAtTheEndThatItWasTold) {
  tell(1, 0.0);
  lasts_ns = 2 * kMs;
  EXPECT_TRUE(tell(2, 8.0));
  now_ns += 2 * kMs - 1;
  EXPECT_EQ(power_w(), 8.0);
  ++now_ns;
  EXPECT_EQ(power_w(), 0.0);
  lasts_ns = 0;
  EXPECT_TRUE(tell(3, 8.0));
  EXPECT_EQ(power_w(), 0.0);
}

TEST_F(Device, ThatIsStuckIsPutOutByItsSupplyAndBySilenceAlone) {
  tell(1, 0.0);
  EXPECT_TRUE(tell(2, 8.0));
  device.stick(20.0);
  EXPECT_EQ(power_w(), 20.0);
  EXPECT_TRUE(tell(3, 0.0));
  EXPECT_EQ(power_w(), 20.0) << "off is not heard";
  EXPECT_EQ(device.answer(now_ns).emission_w, 20.0) << "but measured";
  now_ns += 3 * kMs;
  EXPECT_EQ(power_w(), 0.0);
  EXPECT_TRUE(tell(4, 0.0));
  EXPECT_EQ(power_w(), 20.0);
  enable = 0;
  EXPECT_TRUE(tell(5, 0.0));
  EXPECT_EQ(power_w(), 0.0);
}

/// What no controller says, and what one says at random: the light keeps its bounds, and goes out.
TEST_F(Device, WhateverArrivesItsLightIsWithinBoundsAndEndsBySilence) {
  std::mt19937_64 random(19);
  const auto any_of = [&](auto... values) {
    const std::common_type_t<decltype(values)...> all[] = {values...};
    return all[random() % std::size(all)];
  };
  std::int64_t obeyed_ns = 0;
  int obeyed = 0, lit = 0;
  for (int n = 0; n < 200'000; ++n, now_ns += static_cast<std::int64_t>(random() % (2 * kMs))) {
    if (n % 1000 == 999) now_ns += 600 * kMs;  // whoever spoke has gone
    UdpPower told;
    if (random() % 8 == 0) told.magic = static_cast<std::uint32_t>(random());
    if (random() % 8 == 0) told.version = any_of(0U, 1U, 3U, ~0U);
    told.sequence = random() % 16 == 0 ? any_of(0ULL, 1ULL, ~0ULL) : static_cast<std::uint64_t>(n % 1000);
    told.power_w = any_of(0.0, 0.0, -0.0, 1.0, 8.0, 1e300, -1.0, -1e-300, kNan, kInfinite, -kInfinite);
    told.period_ns = any_of(0U, 1'000'000U, 1'000'000U, 5'000'000U, ~0U);
    told.pilot = any_of(0U, 0U, 1U, 2U);
    told.enable = random() % 16 == 0 ? any_of(0ULL, ~0ULL) : static_cast<std::uint64_t>(n % 1000);
    told.lasts_ns = any_of(0U, 1'000'000U, 2'000'000U, ~0U);
    const std::size_t size = random() % 8 == 0 ? random() % 100 : sizeof(told);
    const UdpLaserDevice::Sender from{boost::asio::ip::address_v4::loopback(),
                                      static_cast<unsigned short>(1 + (random() % 16 == 0 ? 1 : 0))};
    if (device.hear(told, size, from, now_ns)) {
      ASSERT_TRUE(size == sizeof(told) && told.magic == UdpPower::kMagic &&
                  told.version == UdpPower::kVersion);
      obeyed_ns = now_ns;
      period_ns = told.period_ns;
      ++obeyed;
    }
    ASSERT_TRUE(power_w() >= 0.0 && power_w() <= 20.0) << power_w();
    ASSERT_TRUE(power_w() == 0.0 || now_ns - obeyed_ns < udp_silence_ns(period_ns));
    ASSERT_TRUE(device.dark_ns() - obeyed_ns <= udp_silence_ns(period_ns));
    lit += power_w() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(obeyed, 5000);
  EXPECT_GT(lit, 1000);
  now_ns = obeyed_ns + udp_silence_ns(period_ns);
  EXPECT_EQ(power_w(), 0.0);
}

TEST_F(Device, GivesNoPowerWithoutANewEnable) {
  tell(1, 0.0);
  EXPECT_TRUE(tell(2, 8.0));
  --enable;
  EXPECT_FALSE(tell(3, 8.0)) << "the same again";
  EXPECT_TRUE(tell(4, 8.0));
  enable = 0;
  EXPECT_FALSE(tell(5, 8.0));
  EXPECT_TRUE(tell(6, 0.0)) << "off needs none";
  EXPECT_EQ(power_w(), 0.0);
}

}  // namespace
}  // namespace telekerf::laser
