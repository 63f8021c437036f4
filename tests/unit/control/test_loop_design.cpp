// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/control/loop_design.h"
#include "common/control/tracking_law.h"
#include "common/robot/sensor_noise.h"
#include "common/runtime/startup_error.h"

namespace telekerf::control {
namespace {

/// A joint of unit nominal inertia under observer and law, stepped in time: what the design works out in
/// frequencies.
class SteppedLoop {
 public:
  SteppedLoop(const LoopConditions& conditions, const LoopBandwidths& bandwidths, double inertia_ratio)
      : t_(conditions.period_s),
        ratio_(inertia_ratio),
        law_(sampled_gains(bandwidths.law_rad_per_s, 1.0, t_)),
        observer_({.period_s = t_,
                   .bandwidth_rad_per_s = bandwidths.observer_rad_per_s,
                   .velocity_bandwidth_rad_per_s = bandwidths.velocity_rad_per_s,
                   .loop_delay = conditions.delay_s / t_}),
        whole_(static_cast<std::size_t>(conditions.delay_s / t_ + 1e-9)),
        part_s_(conditions.delay_s - static_cast<double>(whole_) * t_) {
    observer_.reset(Vec3::Zero());
    both_.assign(whole_ + 2, 0.0);
  }
  /// One step; returns the acceleration asked for. `push` acts beside it, `noise_m` on the reading.
  double step(double push, double noise_m = 0.0) {
    observer_.update(Vec3::Constant(q_ + noise_m), true);
    const auto now = observer_.ahead();
    const double u = -law_.position * now.joints_m[0] - law_.velocity * now.velocity_m_per_s[0] +
                     observer_.disturbance_n()[0];
    observer_.applied(Vec3::Constant(u), Mat3::Identity());
    for (std::size_t i = both_.size() - 1; i > 0; --i) both_[i] = both_[i - 1];
    both_[0] = u + push;
    move(both_[whole_ + 1] / ratio_, part_s_);
    move(both_[whole_] / ratio_, t_ - part_s_);
    return u;
  }
  double position_m() const { return q_; }
  double speed_m_per_s() const { return v_; }

 private:
  void move(double m_per_s2, double h_s) {
    q_ += h_s * v_ + 0.5 * h_s * h_s * m_per_s2;
    v_ += h_s * m_per_s2;
  }

  double t_;
  double ratio_;
  SampledGains law_;
  DisturbanceObserver observer_;
  std::size_t whole_;         ///< samples of the delay
  double part_s_;             ///< and what is left of it
  std::vector<double> both_;  ///< asked for and pushed in the last steps, newest first
  double q_ = 0.0;
  double v_ = 0.0;
};

/// Largest gain from a sine of force to (force + answer), over a sweep: |S| as an experiment would find it.
double measured_sensitivity(const LoopConditions& conditions, const LoopBandwidths& bandwidths,
                            double ratio) {
  double largest = 0.0;
  for (double hz = 20.0; hz < 480.0; hz *= 1.02) {
    SteppedLoop loop(conditions, bandwidths, ratio);
    const double w = 2.0 * M_PI * hz * conditions.period_s;
    double cosine = 0.0, sine = 0.0;
    constexpr int kSettle = 3000, kMeasure = 3000;
    for (int n = 0; n < kSettle + kMeasure; ++n) {
      const double push = std::sin(w * n);
      const double both = push + loop.step(push);
      if (n < kSettle) continue;
      cosine += both * std::cos(w * n);
      sine += both * std::sin(w * n);
    }
    largest = std::max(largest, 2.0 * std::hypot(cosine, sine) / kMeasure);
  }
  return largest;
}

TEST(LoopMargins, AreWhatASweepInTimeShows) {
  for (const double delay_s : {0.0, 0.4e-3, 1e-3, 1.08e-3}) {
    const LoopConditions conditions{.period_s = 1e-3, .delay_s = delay_s};
    const LoopBandwidths bandwidths =
        delay_s < 1e-3 ? LoopBandwidths{400, 1000, 3000} : LoopBandwidths{150, 400, 1500};
    for (const double ratio : {0.7, 1.0, 1.3}) {
      const LoopMargins margins = loop_margins(conditions, bandwidths, ratio);
      ASSERT_TRUE(margins.stable);
      const double measured = measured_sensitivity(conditions, bandwidths, ratio);
      EXPECT_NEAR(margins.max_sensitivity, measured, 0.02 * measured) << delay_s << " " << ratio;
    }
  }
}

TEST(LoopMargins, OfASensorsNoiseAreWhatItMakesInTime) {
  const LoopConditions conditions{.period_s = 1e-3, .noise_m = 0.2e-6};
  const LoopBandwidths bandwidths{400, 1000, 3000};
  SteppedLoop loop(conditions, bandwidths, 1.0);
  std::uint64_t state = 1;
  double squares = 0.0, speeds = 0.0;
  constexpr int kSteps = 200'000;
  for (int n = 0; n < kSteps; ++n) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double uniform = static_cast<double>(state >> 11) * 0x1.0p-53 - 0.5;
    const double u = loop.step(0.0, conditions.noise_m * std::sqrt(12.0) * uniform);
    squares += u * u;
    speeds += loop.speed_m_per_s() * loop.speed_m_per_s();
  }
  const double measured = std::sqrt(squares / kSteps);
  EXPECT_NEAR(loop_margins(conditions, bandwidths).noise_m_per_s2, measured, 0.03 * measured);
  const double shaken = std::sqrt(speeds / kSteps);
  EXPECT_NEAR(loop_margins(conditions, bandwidths).noise_m_per_s, shaken, 0.03 * shaken);
}

TEST(LoopMargins, ALoopThatRunsAwayInTimeIsNotStable) {
  const LoopConditions late{.period_s = 1e-3, .delay_s = 2e-3};
  const LoopBandwidths fast{300, 900, 2700};
  EXPECT_FALSE(loop_margins(late, fast, kWorstInertiaRatio).stable);
  SteppedLoop loop(late, fast, kWorstInertiaRatio);
  for (int n = 0; n < 500; ++n) loop.step(n == 0 ? 1.0 : 0.0);
  EXPECT_GT(std::abs(loop.position_m()), 1e-3);
}

TEST(LoopMargins, AreThoseOfTheLoopUpToWhereItIsNoLongerStable) {
  const LoopConditions conditions{.period_s = 1e-3, .delay_s = 1e-3};
  const auto with = [](double law) { return LoopBandwidths{law, 2.5 * law, 12.5 * law}; };
  double low = 100.0, high = 2000.0;
  ASSERT_TRUE(loop_margins(conditions, with(low), kWorstInertiaRatio).stable);
  ASSERT_FALSE(loop_margins(conditions, with(high), kWorstInertiaRatio).stable);
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (loop_margins(conditions, with(middle), kWorstInertiaRatio).stable ? low : high) = middle;
  }
  const auto rest_m = [&](double law) {
    SteppedLoop loop(conditions, with(law), kWorstInertiaRatio);
    double last_m = 0.0;
    for (int n = 0; n < 6000; ++n) {
      loop.step(n == 0 ? 1.0 : 0.0);
      if (n >= 5900) last_m = std::max(last_m, std::abs(loop.position_m()));
    }
    return last_m;
  };
  EXPECT_LT(rest_m(0.97 * low), 1e-9) << "the push of a step is forgotten at " << low << " rad/s";
  EXPECT_GT(rest_m(1.03 * low), 1e-3) << "and grows beyond it";
}

TEST(LoopDesign, IsTheFastestWithinItsMarginsAndFollowsTheRate) {
  for (const double delay : {0.0, 0.5, 1.0, 2.0}) {
    const LoopConditions conditions{.period_s = 1e-3, .delay_s = delay * 1e-3};
    const LoopBandwidths chosen = design_loop(conditions);
    EXPECT_NEAR(chosen.observer_rad_per_s, 2.5 * chosen.law_rad_per_s, 1e-9);
    EXPECT_NEAR(chosen.velocity_rad_per_s, 5.0 * chosen.observer_rad_per_s, 1e-9);
    const auto good = [&](double factor) {
      LoopBandwidths b = chosen;
      for (double* w : {&b.law_rad_per_s, &b.observer_rad_per_s, &b.velocity_rad_per_s}) *w *= factor;
      const LoopMargins nominal = loop_margins(conditions, b);
      const LoopMargins worst = loop_margins(conditions, b, kWorstInertiaRatio);
      return nominal.stable && nominal.max_sensitivity <= kMaxSensitivity && worst.stable &&
             worst.max_sensitivity <= kMaxSensitivityWorst;
    };
    EXPECT_TRUE(good(1.0)) << delay;
    EXPECT_FALSE(good(1.02)) << delay;
    const LoopConditions twice{.period_s = 0.5e-3, .delay_s = delay * 0.5e-3};
    EXPECT_NEAR(design_loop(twice).law_rad_per_s, 2.0 * chosen.law_rad_per_s, 0.02 * chosen.law_rad_per_s);
  }
  EXPECT_NEAR(design_loop({.period_s = 1e-3}).law_rad_per_s, 500.0, 15.0);
  EXPECT_NEAR(design_loop({.period_s = 1e-3, .delay_s = 1e-3}).law_rad_per_s, 175.0, 20.0);
}

TEST(LoopDesign, NoiseBoundsItWhereTheRateWouldNot) {
  const LoopConditions quiet{.period_s = 2e-4, .noise_m = 0.15e-6, .max_noise_m_per_s2 = 2.0};
  const LoopBandwidths chosen = design_loop(quiet);
  EXPECT_NEAR(loop_margins(quiet, chosen).noise_m_per_s2, 2.0, 0.1);
  LoopConditions loud = quiet;
  loud.noise_m *= 10.0;
  EXPECT_LT(design_loop(loud).law_rad_per_s, 0.6 * chosen.law_rad_per_s);
}

TEST(LoopDesign, KeepsWhatIsGivenAndFitsTheRest) {
  const LoopConditions conditions{.period_s = 1e-3};
  EXPECT_EQ(design_loop(conditions, 60.0, 600.0).law_rad_per_s, 60.0);
  EXPECT_EQ(design_loop(conditions, 60.0, 600.0).observer_rad_per_s, 600.0);
  EXPECT_EQ(design_loop(conditions, 60.0).observer_rad_per_s, 150.0);
  const LoopBandwidths fitted = design_loop(conditions, 0.0, 300.0);
  EXPECT_EQ(fitted.observer_rad_per_s, 300.0);
  EXPECT_GT(fitted.law_rad_per_s, 300.0);
}

TEST(LoopDesign, OfARobotDoesNotDependOnItsMass) {
  robot::RobotModel heavy = robot::load_robot("master-horizontal");
  robot::RobotModel light = heavy;
  light.motor.mass_kg *= 0.25;
  light.tool_mass_kg *= 0.25;
  const auto law = [](const robot::RobotModel& model) {
    return design_loop(loop_conditions(model, 1000.0)).law_rad_per_s;
  };
  EXPECT_EQ(law(heavy), law(light));
  heavy.drive_delay_s = 1e-3;
  EXPECT_LT(law(heavy), 0.5 * law(light));
  const JointAccelerationSettings joints = joints_of(heavy, {100, 200, 300}, 2000.0);
  EXPECT_EQ(joints.observer.loop_delay, 2.0);
  EXPECT_EQ(joints.observer.bandwidth_rad_per_s, 200.0);
  EXPECT_EQ(joints.observer.velocity_bandwidth_rad_per_s, 300.0);
  EXPECT_TRUE(joints.present);
}

TEST(LoopDesign, AnEvenLoopIsAsFastAsItsNoiseAllows) {
  const LoopConditions conditions{.period_s = 1.0 / 2400.0, .delay_s = 1.0 / 2400.0, .noise_m = 0.1e-6};
  const ObserverBounds bounds{60.0, 500.0};
  const auto shaken = [&](const LoopBandwidths& loop) {
    return loop_margins(conditions, loop).noise_m_per_s;
  };
  for (const double max_m_per_s : {10e-6, 15e-6, 20e-6}) {
    const LoopBandwidths loop = design_even_loop(conditions, 70.0, max_m_per_s, bounds);
    EXPECT_NEAR(shaken(loop), max_m_per_s, 0.02 * max_m_per_s);
    EXPECT_EQ(loop.law_rad_per_s, 70.0);
    EXPECT_DOUBLE_EQ(loop.velocity_rad_per_s, 3.0 * loop.observer_rad_per_s);
  }
  EXPECT_EQ(design_even_loop(conditions, 70.0, 1.0, bounds).observer_rad_per_s, 500.0);
  EXPECT_NEAR(design_even_loop(conditions, 70.0, 0.0, bounds).observer_rad_per_s, 60.0, 1.0);
}

TEST(LoopDesign, WhatCannotWorkIsRefused) {
  const auto refusal = [](double delay_s, const LoopBandwidths& bandwidths) {
    try {
      require_stable({.period_s = 1e-3, .delay_s = delay_s}, bandwidths, "constraint_rad_s",
                     "observer_rad_s");
      return std::string();
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal(0.0, {400, 1000, 3000}), "");
  EXPECT_NE(refusal(2e-3, {900, 2700, 8100}).find("constraint_rad_s = 900 and observer_rad_s = 2700"),
            std::string::npos);
  EXPECT_EQ(refusal(4e-3, {40, 100, 300}), "");
  EXPECT_NE(refusal(4.1e-3, {40, 100, 300}).find("drive_delay_s = 0.0041 of the robot is more than 4"),
            std::string::npos);
}

TEST(ReadingNoise, IsACountsOrTheHallChannels) {
  EXPECT_NEAR(robot::reading_noise_m({.resolution_m = 1e-6}), 0.288675e-6, 1e-12);
  robot::Sensor hall{.kind = robot::Sensor::Kind::kHall, .pitch_m = 0.018, .adc_bits = 24, .noise = 2e-4};
  EXPECT_NEAR(robot::reading_noise_m(hall), std::sqrt(2.0 / 3.0) * 2e-4 * 0.018 / (2 * M_PI), 1e-12);
  hall.conversions = 16;
  EXPECT_NEAR(robot::reading_noise_m(hall), 0.25 * std::sqrt(2.0 / 3.0) * 2e-4 * 0.018 / (2 * M_PI), 1e-12);
  hall.adc_bits = 8;
  EXPECT_NEAR(robot::reading_noise_m(hall), 6.6e-6, 0.3e-6) << "the converter's steps";
}

}  // namespace
}  // namespace telekerf::control
