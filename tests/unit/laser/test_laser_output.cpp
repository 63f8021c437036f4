// SPDX-License-Identifier: Apache-2.0
// The choice of a laser, and the limits above whatever was chosen.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "slave/laser/laser_output.h"
#include "tests/unit/laser/permits.h"

namespace telekerf::laser {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
  EXPECT_NE(refusal_of(stated("spi"), 10.0).find("laser = spi: must be one of"), std::string::npos);
  EXPECT_NE(refusal_of(stated("udp:no.such.host.invalid:7200"), 10.0).find("give the host's IPv4 address"),
            std::string::npos);
}

TEST(Laser, IsNamedByASettingThatRefusesWhatIsNone) {
  LaserOutputSettings output;
  Settings settings;
  output.add_parameters(settings);
  settings.load(std::vector<std::string>{"--laser", "udp:127.0.0.1:7200", "--laser-max-w", "5"});
  EXPECT_EQ(output.laser, "udp:127.0.0.1:7200");
  EXPECT_EQ(output.laser_max_w, 5.0);
  EXPECT_THROW(settings.load(std::vector<std::string>{"--laser", "spi"}), StartupError);
}

TEST(Laser, MoreThanItMayGiveIsRefusedBeforeTheStart) {
  LaserOutputSettings settings;
  EXPECT_EQ(settings.max_w(), 1000.0);
  EXPECT_EQ(refusal_of(settings, 1000.5),
            "laser_w = 1000.5 must be at most laser_max_w = 1000; lower it, or raise laser_max_w if the "
            "laser can give more");
  settings.laser_max_w = 0.05;
  EXPECT_EQ(settings.max_w(), 0.05) << "however little";
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
  bool emit(const Emission& emission) noexcept override {
    steps_.push_back({emission.power_w, emission.pilot});
    newest = emission;
    return reached;
  }
  bool stray() noexcept override { return lights; }

  Emission newest;
  bool lights = false;

  bool reached;

 private:
  std::vector<Step>& steps_;
};

TEST(LaserOutput, IsOffBeforeTheFirstStepAndAfterTheLast) {
  std::vector<Told::Step> steps;
  {
    Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::make_unique<Told>(steps));
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
  Permitted beam(settings, 10.0, 1000.0, std::make_unique<Told>(steps));
  for (const double wrong : {-1.0, -1e-300, kNan, kInfinite, -kInfinite}) {
    EXPECT_EQ(beam.emit(wrong, false), 0.0) << wrong;
    EXPECT_EQ(steps.back(), (Told::Step{0.0, false})) << wrong;
  }
  EXPECT_EQ(beam.output.clipped(), 0u);
  EXPECT_EQ(beam.emit(1e-3, false), 1e-3) << "however little";
  EXPECT_EQ(beam.emit(12.0, false), 12.0);
  EXPECT_EQ(beam.output.clipped(), 0u);
  EXPECT_EQ(beam.emit(15.0, false), 12.0);
  EXPECT_EQ(steps.back(), (Told::Step{12.0, false}));
  EXPECT_EQ(beam.output.clipped(), 1u);
  EXPECT_EQ(beam.output.write_failures(), 0u);
}

TEST(LaserOutput, WithoutAPermitOfThisVeryStepThereIsNoLightButThePilots) {
  std::vector<Told::Step> steps;
  LaserOutput beam({}, 10.0, 1000.0, std::make_unique<Told>(steps));
  Permits permits;
  EXPECT_EQ(beam.emit({}, 0, 8.0, true), 0.0) << "nobody's";
  EXPECT_EQ(steps.back(), (Told::Step{0.0, true}));
  EXPECT_EQ(beam.unpermitted(), 1u);
  Permit stale = permits.next();
  EXPECT_EQ(beam.emit(std::move(stale), permits.now_ns + 2 * Permits::kPeriod_ns, 8.0, false), 0.0);
  Permit early = permits.next();
  EXPECT_EQ(beam.emit(std::move(early), permits.now_ns - 1, 8.0, false), 0.0) << "before it was made";
  EXPECT_EQ(beam.unpermitted(), 3u);
  Permit older = permits.next();
  Permit newer = permits.next();
  EXPECT_EQ(beam.emit(std::move(newer), permits.now_ns, 8.0, false), 8.0);
  EXPECT_EQ(beam.emit(std::move(older), permits.now_ns, 8.0, false), 0.0) << "one as new was used";
  EXPECT_EQ(beam.emit(std::move(newer), permits.now_ns, 8.0, false), 0.0) << "it was used";  // NOLINT
  EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  EXPECT_EQ(beam.unpermitted(), 5u);
  Permit last = permits.next();
  EXPECT_EQ(beam.emit(std::move(last), permits.now_ns + 2 * Permits::kPeriod_ns - 1, 8.0, false), 8.0);
  EXPECT_EQ(beam.emit({}, permits.now_ns, 0.0, false), 0.0);
  EXPECT_EQ(beam.unpermitted(), 5u) << "off needs none";
}

TEST(LaserOutput, GivesNoMoreThanWasJudged) {
  std::vector<Told::Step> steps;
  LaserOutput beam({}, 10.0, 1000.0, std::make_unique<Told>(steps));
  Permits permits;
  for (const double power_w : {6.0, 5.0}) {
    Permit permit = permits.next(5.0);
    EXPECT_EQ(beam.emit(std::move(permit), permits.now_ns, power_w, false), 5.0);
  }
  EXPECT_EQ(beam.unpermitted(), 1u);
  EXPECT_EQ(beam.clipped(), 0u);
}

TEST(Laser, ThatIsNotSimulatedHasItsLargestPowerStated) {
  EXPECT_EQ(refusal_of(named("udp:127.0.0.1:7200"), 0.0),
            "laser = udp:127.0.0.1:7200: laser_max_w must be stated for a laser that is not simulated; give "
            "the power "
            "that it may never exceed");
  EXPECT_NO_THROW(stated("udp:127.0.0.1:7200", 0.05).validate(0.05)) << "however little it is";
}

TEST(LaserOutput, TellsTheLaserWhenTheLightEndsAndByWhichPermit) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps);
  const Told& told = *laser;
  LaserOutput beam({}, 10.0, 1000.0, std::move(laser));
  EXPECT_EQ(told.newest.lasts_ns, 0);
  EXPECT_EQ(told.newest.enable, 0u);
  Permits permits;
  for (std::uint64_t tick = 1; tick <= 2; ++tick) {
    Permit permit = permits.next();
    beam.emit(std::move(permit), permits.now_ns + 300, 5.0, false);
    EXPECT_EQ(told.newest.lasts_ns, 2 * Permits::kPeriod_ns - 300);
    EXPECT_EQ(told.newest.enable, tick);
  }
  beam.emit({}, permits.now_ns, 5.0, true);
  EXPECT_EQ(told.newest.enable, 0u) << "the pilot's";
  EXPECT_EQ(told.newest.lasts_ns, 2 * Permits::kPeriod_ns);
}

TEST(LaserOutput, ALaserThatGivesLightThoughToldToBeOffIsGivenUpAtTheSecondStep) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps);
  Told& told = *laser;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::move(laser));
  for (int n = 0; n < 5; ++n) {
    told.lights = true;
    EXPECT_EQ(beam.emit(5.0, false), 5.0);
    told.lights = false;
    beam.emit(5.0, false);
  }
  EXPECT_TRUE(beam.output.emission_agrees()) << "never twice in a row";
  told.lights = true;
  beam.emit(0.0, false);
  EXPECT_FALSE(beam.output.failed());
  beam.emit(0.0, false);
  EXPECT_TRUE(beam.output.failed());
  EXPECT_FALSE(beam.output.emission_agrees());
  told.lights = false;
  EXPECT_EQ(beam.emit(5.0, true), 0.0) << "for good";
  EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  EXPECT_NE(beam.output.failure().find("gives light that it was not told to give"), std::string::npos);
}

TEST(LaserOutput, ALaserThatGivesLightBeforeTheFirstStepIsGivenUpAtThatStepAndNotBefore) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps);
  laser->lights = true;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::move(laser));
  EXPECT_TRUE(beam.output.emission_agrees()) << "once is not enough";
  EXPECT_FALSE(beam.output.failed());
  beam.emit(0.0, false);
  EXPECT_TRUE(beam.output.failed());
}

TEST(LaserOutput, CountsStepsInWhichTheLaserWasNotTold) {
  std::vector<Told::Step> steps;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::make_unique<Told>(steps, false));
  EXPECT_FALSE(beam.output.failed());
  for (int n = 0; n < 3; ++n) beam.emit(1.0, false);
  EXPECT_EQ(beam.output.write_failures(), 4u);
}

TEST(LaserOutput, LosesALaserThatIsNotToldTimeAndAgain) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps, true);
  Told& told = *laser;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::move(laser));
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
  EXPECT_FALSE(beam.output.failed()) << "twice in eight seconds, over and over, is forgiven";
  for (int n = 0; n < 3; ++n) {
    EXPECT_FALSE(beam.output.failed());
    emit(false, 1);
    emit(true, 1000);
  }
  EXPECT_FALSE(beam.output.failed());
  emit(false, 1);
  EXPECT_TRUE(beam.output.failed()) << "once a second is not";
  EXPECT_EQ(emit(true, 1), 0.0) << "for good";
  EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  EXPECT_NE(beam.output.failure().find("laser = simulated: it no longer hears"), std::string::npos)
      << beam.output.failure();
}

/// 256 Hz: what is forgotten in a step is a whole share of a doubt in four seconds, 1 / 1024.
TEST(LaserOutput, ThreeUntoldStepsAreEnoughAndOneIsForgottenInFourSeconds) {
  std::vector<Told::Step> steps;
  const auto lost_after = [&](int told_steps) {
    auto laser = std::make_unique<Told>(steps, true);
    Told& told = *laser;
    Permitted beam(LaserOutputSettings{}, 10.0, 256.0, std::move(laser));
    const auto emit = [&](bool reached, int times) {
      told.reached = reached;
      for (int n = 0; n < times; ++n) beam.emit(8.0, false);
    };
    emit(true, 5000);  // no credit is saved up
    emit(false, 2);
    EXPECT_FALSE(beam.output.failed());
    emit(true, told_steps);
    emit(false, told_steps == 0 ? 1 : 2);
    EXPECT_EQ(beam.output.write_failures(), told_steps == 0 ? 3u : 4u);
    return beam.output.failed();
  };
  EXPECT_TRUE(lost_after(0)) << "three in a row";
  EXPECT_TRUE(lost_after(1024)) << "a fourth when one of three was forgotten";
  EXPECT_FALSE(lost_after(1025));
}

TEST(LaserOutput, ANewOneHasNoDoubtsYet) {
  std::vector<Told::Step> steps;
  auto laser = std::make_unique<Told>(steps, true);
  Told& told = *laser;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::move(laser));
  const auto emit = [&](bool reached, int times) {
    told.reached = reached;
    for (int n = 0; n < times; ++n) beam.emit(8.0, false);
  };
  emit(false, 2);
  emit(true, 200);  // a twentieth is forgotten
  emit(false, 1);
  EXPECT_FALSE(beam.output.failed()) << "2.95";
  emit(false, 1);
  EXPECT_TRUE(beam.output.failed());
}

TEST(LaserOutput, ALostLaserIsToldToBeOffAtEveryStepAndItsPilotToo) {
  std::vector<Told::Step> steps;
  Permitted beam(LaserOutputSettings{}, 10.0, 1000.0, std::make_unique<Told>(steps, false));
  EXPECT_EQ(beam.emit(8.0, true), 8.0) << "the beam's off at first was the first doubt";
  EXPECT_EQ(beam.emit(8.0, true), 8.0);
  EXPECT_TRUE(beam.output.failed());
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(beam.emit(8.0, true), 0.0);
    EXPECT_EQ(steps.back(), (Told::Step{0.0, false}));
  }
  EXPECT_EQ(beam.output.write_failures(), 8u);
}

}  // namespace
}  // namespace telekerf::laser
