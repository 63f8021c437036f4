// SPDX-License-Identifier: Apache-2.0
// The choice of a laser, the limits above whatever was chosen, and the laser behind a UDP address.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "common/runtime/startup_error.h"
#include "slave/laser/laser_output.h"
#include "tests/unit/allocations.h"
#include "tests/unit/laser/laser_device.h"

namespace telekerf::laser {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

LaserOutputSettings named(const std::string& laser) {
  LaserOutputSettings settings;
  settings.laser = laser;
  return settings;
}

std::string refusal_of(const LaserOutputSettings& settings, double laser_w) {
  try {
    const LaserOutput beam(settings, laser_w, 1000.0);
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(Laser, WhatIsNoneIsRefusedWithWhatItMustBe) {
  for (const char* wrong : {"", "Simulated", "spi", "spi:0"}) {
    EXPECT_NE(validate_laser(wrong).find("must be one of simulated, udp:HOST:PORT"), std::string::npos)
        << wrong;
  }
  EXPECT_EQ(validate_laser("simulated:2"), "stands alone, nothing follows its name");
  for (const char* wrong : {"udp", "udp:7200", "udp::7200", "udp:host:0", "udp:host:65536"}) {
    EXPECT_NE(validate_laser(wrong).find("within [1, 65535]"), std::string::npos) << wrong;
  }
  EXPECT_EQ(validate_laser("udp:127.0.0.1:7200"), "");
  EXPECT_EQ(refusal_of(named("simulated"), 10.0), "accepted");
  EXPECT_NE(refusal_of(named("spi"), 10.0).find("laser = spi: must be one of"), std::string::npos);
  EXPECT_NE(refusal_of(named("udp:no.such.host.invalid:7200"), 10.0).find("give the host's IPv4 address"),
            std::string::npos);
}

TEST(Laser, MoreThanItMayGiveIsRefusedBeforeTheStart) {
  LaserOutputSettings settings;
  EXPECT_EQ(settings.laser_max_w, 1000.0);
  settings.laser_max_w = 20.0;
  EXPECT_EQ(refusal_of(settings, 20.0), "accepted");
  EXPECT_EQ(
      refusal_of(settings, 20.5),
      "laser_w = 20.5 must be at most laser_max_w = 20; lower it, or raise laser_max_w if the laser can "
      "give more");
}

/// Remembers what it was told; may be out of reach.
class Told : public Laser {
 public:
  struct Step {
    double power_w;
    bool pilot;
    bool operator==(const Step&) const = default;
  };
  explicit Told(std::vector<Step>& steps, bool within_reach = true) : reached(within_reach), steps_(steps) {}
  bool emit(double power_w, bool pilot) noexcept override {
    steps_.push_back({power_w, pilot});
    return reached;
  }

  bool reached;

 private:
  std::vector<Step>& steps_;
};

TEST(LaserOutput, IsOffBeforeTheFirstStepAndAfterTheLast) {
  std::vector<Told::Step> steps;
  {
    LaserOutput beam({}, 10.0, 1000.0, std::make_unique<Told>(steps));
    EXPECT_EQ(steps, (std::vector<Told::Step>{{0.0, false}}));
    EXPECT_EQ(beam.emit(4.0, false), 4.0);
    EXPECT_EQ(beam.emit(0.0, true), 0.0);
    EXPECT_EQ(steps.back(), (Told::Step{0.0, true}));
    EXPECT_EQ(beam.emit(5.0, true), 5.0);
    EXPECT_EQ(steps.back(), (Told::Step{5.0, true}));
  }
  EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  EXPECT_EQ(steps.size(), 5u);
}

TEST(LaserOutput, GivesNothingThatIsNoPowerAndNeverMoreThanItsLimit) {
  std::vector<Told::Step> steps;
  LaserOutputSettings settings;
  settings.laser_max_w = 12.0;
  LaserOutput beam(settings, 10.0, 1000.0, std::make_unique<Told>(steps));
  for (const double wrong : {-1.0, -1e-300, kNan, kInfinite, -kInfinite}) {
    EXPECT_EQ(beam.emit(wrong, false), 0.0) << wrong;
    EXPECT_EQ(steps.back(), (Told::Step{0.0, false})) << wrong;
  }
  EXPECT_EQ(beam.clipped(), 0u);
  EXPECT_EQ(beam.emit(1e-3, false), 1e-3) << "however little";
  EXPECT_EQ(beam.emit(12.0, false), 12.0);
  EXPECT_EQ(beam.clipped(), 0u);
  EXPECT_EQ(beam.emit(15.0, false), 12.0);
  EXPECT_EQ(steps.back(), (Told::Step{12.0, false}));
  EXPECT_EQ(beam.clipped(), 1u);
  EXPECT_EQ(beam.write_failures(), 0u);
}

TEST(LaserOutput, CountsStepsInWhichTheLaserWasNotTold) {
  std::vector<Told::Step> steps;
  LaserOutput beam({}, 10.0, 1000.0, std::make_unique<Told>(steps, false));
  EXPECT_FALSE(beam.failed());
  for (int n = 0; n < 3; ++n) beam.emit(1.0, false);
  EXPECT_EQ(beam.write_failures(), 4u);
}

TEST(LaserOutput, LosesALaserThatIsNotToldTimeAndAgain) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps, true);
  Told& told = *laser;
  LaserOutput beam({}, 10.0, 1000.0, std::move(laser));
  const auto emit = [&](bool reached, int times) {
    told.reached = reached;
    double power_w = 0.0;
    for (int n = 0; n < times; ++n) power_w = beam.emit(8.0, true);
    return power_w;
  };
  for (int n = 0; n < 5; ++n) {
    emit(false, 2);
    emit(true, 8000);
  }
  EXPECT_FALSE(beam.failed()) << "twice in eight seconds, over and over, is forgiven";
  for (int n = 0; n < 3; ++n) {
    EXPECT_FALSE(beam.failed());
    emit(false, 1);
    emit(true, 1000);
  }
  EXPECT_FALSE(beam.failed());
  emit(false, 1);
  EXPECT_TRUE(beam.failed()) << "once a second is not";
  EXPECT_EQ(emit(true, 1), 0.0) << "for good";
  EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  EXPECT_NE(beam.failure().find("laser = simulated: it no longer hears"), std::string::npos)
      << beam.failure();
}

/// 256 Hz: what is forgotten in a step is a whole share of a doubt in four seconds, 1 / 1024.
TEST(LaserOutput, ThreeUntoldStepsAreEnoughAndOneIsForgottenInFourSeconds) {
  std::vector<Told::Step> steps;
  const auto lost_after = [&](int told_steps) {
    auto laser = std::make_unique<Told>(steps, true);
    Told& told = *laser;
    LaserOutput beam({}, 10.0, 256.0, std::move(laser));
    const auto emit = [&](bool reached, int times) {
      told.reached = reached;
      for (int n = 0; n < times; ++n) beam.emit(8.0, false);
    };
    emit(true, 5000);  // no credit is saved up
    emit(false, 2);
    EXPECT_FALSE(beam.failed());
    emit(true, told_steps);
    emit(false, told_steps == 0 ? 1 : 2);
    EXPECT_EQ(beam.write_failures(), told_steps == 0 ? 3u : 4u);
    return beam.failed();
  };
  EXPECT_TRUE(lost_after(0)) << "three in a row";
  EXPECT_TRUE(lost_after(1024)) << "a fourth when one of three was forgotten";
  EXPECT_FALSE(lost_after(1025));
}

TEST(LaserOutput, ANewOneHasNoDoubtsYet) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps, true);
  Told& told = *laser;
  LaserOutput beam({}, 10.0, 1000.0, std::move(laser));
  const auto emit = [&](bool reached, int times) {
    told.reached = reached;
    for (int n = 0; n < times; ++n) beam.emit(8.0, false);
  };
  emit(false, 2);
  emit(true, 200);  // a twentieth is forgotten
  emit(false, 1);
  EXPECT_FALSE(beam.failed()) << "2.95";
  emit(false, 1);
  EXPECT_TRUE(beam.failed());
}

TEST(LaserOutput, ALostLaserIsToldToBeOffAtEveryStepAndItsPilotToo) {
  std::vector<Told::Step> steps;
  LaserOutput beam({}, 10.0, 1000.0, std::make_unique<Told>(steps, false));
  EXPECT_EQ(beam.emit(8.0, true), 8.0) << "the beam's off at first was the first doubt";
  EXPECT_EQ(beam.emit(8.0, true), 8.0);
  EXPECT_TRUE(beam.failed());
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(beam.emit(8.0, true), 0.0);
    EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  }
  EXPECT_EQ(beam.write_failures(), 8u);
}

TEST(UdpLaser, TellsEachStepAndAllocatesNothing) {
  EXPECT_EQ(UdpPower{}.magic, 0x4c554b54u);
  EXPECT_EQ(UdpPower{}.version, 1u);
  EXPECT_EQ(UdpPower{}.sequence, 0u);
  EXPECT_EQ(UdpPower{}.power_w, 0.0);
  EXPECT_EQ(UdpPower{}.period_ns, 0u);
  EXPECT_EQ(UdpPower{}.pilot, 0u);
  LaserSocket socket;
  UdpLaser laser(socket.address(), 2400.0);
  std::uint64_t sequence = 0;
  while (const auto arrival = socket.take()) {
    EXPECT_EQ(arrival->told.power_w, 0.0) << "off at first";
    EXPECT_GT(arrival->told.sequence, sequence);
    sequence = arrival->told.sequence;
  }
  EXPECT_EQ(sequence, 2u) << "a second time, to hear what became of the first";
  const auto before = testing::allocations();
  bool told = true;
  for (int n = 0; n < 100; ++n) told = laser.emit(0.1 * n, n % 2 == 1) && told;
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_TRUE(told);
  for (int n = 0; n < 100; ++n) {
    const auto arrival = socket.take();
    ASSERT_TRUE(arrival.has_value()) << n;
    EXPECT_EQ(arrival->size, 32u);
    EXPECT_EQ(arrival->told.magic, UdpPower::kMagic);
    EXPECT_EQ(arrival->told.version, 1u);
    EXPECT_EQ(arrival->told.sequence, ++sequence);
    EXPECT_EQ(arrival->told.power_w, 0.1 * n);
    EXPECT_EQ(arrival->told.pilot, n % 2);
    EXPECT_EQ(arrival->told.period_ns, 416667u);
  }
}

TEST(UdpLaser, WhereNobodyListensIsRefused) {
  std::string laser;
  {
    const LaserSocket closed;
    laser = closed.laser();
  }
  EXPECT_EQ(
      refusal_of(named(laser), 10.0),
      "laser = " + laser + ": Connection refused; is the laser switched on, connected, and its port right?");
}

TEST(UdpLaser, ThatGoesAwayIsLost) {
  auto socket = std::make_unique<LaserSocket>();
  LaserOutput beam(named(socket->laser()), 10.0, 1000.0);
  for (int n = 0; n < 10; ++n) beam.emit(1.0, false);
  EXPECT_EQ(beam.write_failures(), 0u);
  socket.reset();
  for (int n = 0; n < 10; ++n) beam.emit(1.0, false);
  EXPECT_TRUE(beam.failed());
}

TEST(UdpLaser, IsToldAnewInTheSameStepWhenTheDatagramBeforeFailed) {
  auto socket = std::make_unique<LaserSocket>();
  const unsigned short port = socket->address().port;
  UdpLaser laser(socket->address(), 1000.0);
  socket.reset();
  EXPECT_TRUE(laser.emit(1.0, false)) << "nobody has answered yet";
  LaserSocket again(port);
  EXPECT_FALSE(laser.emit(2.0, true));
  const auto arrival = again.take();
  ASSERT_TRUE(arrival.has_value());
  EXPECT_EQ(arrival->told.power_w, 2.0);
  EXPECT_EQ(arrival->told.pilot, 1u);
  EXPECT_TRUE(laser.emit(3.0, false));
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
    return device.hear(told, sizeof(told), {boost::asio::ip::address_v4::loopback(), from}, now_ns);
  }
  double power_w() const { return device.power_w(now_ns); }

  LaserDevice device{20.0};
  std::uint32_t period_ns = kMs;
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

}  // namespace
}  // namespace telekerf::laser
