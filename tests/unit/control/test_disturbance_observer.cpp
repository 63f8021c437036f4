// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/control/disturbance_observer.h"

namespace telekerf::control {
namespace {

/// One joint of mass `mass`, force held per sample: exact motion.
struct Joint {
  double q = 0, v = 0;
  void step(double acceleration, double t) {
    q += t * v + 0.5 * t * t * acceleration;
    v += t * acceleration;
  }
};

// Eq. 22 with the corrected sign: plant A = A_n + dA, K = K_n + dK, constant external force.
TEST(DisturbanceObserver, FindsParametersAndExternalForceAsOneDisturbance) {
  const double t = 1e-3;
  const double mass_n = 0.4, mass = 0.5, k_n = 10, k = 9, external = 0.8, current = 0.2;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  observer.reset(Vec3::Zero());
  const double acceleration = (k * current - external) / mass;
  for (int i = 0; i < 200; ++i) {
    observer.applied(Vec3::Constant(k_n * current), mass_n * Mat3::Identity());
    joint.step(acceleration, t);
    observer.update(Vec3::Constant(joint.q), true);
  }
  const double printed_dk = k - k_n;  // opposite sign to dA: T_dis = -dK i + dA qdd + T_ext
  const double expected = -printed_dk * current + (mass - mass_n) * acceleration + external;
  EXPECT_NEAR(observer.disturbance_n()[0], expected, 1e-9);
  EXPECT_NEAR(observer.disturbance_n()[0], k_n * current - mass_n * acceleration, 1e-9);
  EXPECT_NEAR(observer.joint_velocity_m_per_s()[1], joint.v, 1e-12);
}

// The discrete design is exact: the error of position, velocity and disturbance dies with the poles that were
// asked for, whatever the sample period.
TEST(DisturbanceObserver, PolesAreWhereTheyWereAsked) {
  for (const double t : {1e-3, 1.0 / 2400, 5e-3}) {
    const double g = 200, f = 700;
    DisturbanceObserver observer({t, g, f});
    observer.reset(Vec3::Zero());
    observer.applied(Vec3::Zero(), Mat3::Identity());
    Joint joint;
    joint.v = 0.3;
    std::vector<double> errors;
    for (int i = 0; i < 8; ++i) {
      joint.step(-2.0, t);
      observer.update(Vec3::Constant(joint.q), true);
      errors.push_back(observer.disturbance_n()[0] - 2.0);
    }
    // The error sequence obeys e[k+3] = s1 e[k+2] - s2 e[k+1] + s3 e[k] with the symmetric sums of the poles.
    const double a = std::exp(-g * t), b = std::exp(-f * t);
    const double s1 = a + 2 * b, s2 = 2 * a * b + b * b, s3 = a * b * b;
    for (std::size_t k = 0; k + 3 < errors.size(); ++k) {
      const double expected = s1 * errors[k + 2] - s2 * errors[k + 1] + s3 * errors[k];
      EXPECT_NEAR(errors[k + 3], expected, 1e-9 * std::abs(errors[0])) << "period " << t;
    }
  }
}

// From reading to reading the error dies with the same poles, however far apart they are.
TEST(DisturbanceObserver, PolesStayWhereReadingsAreMissing) {
  const double t = 1e-3, g = 60, f = 200;
  for (const int apart : {2, 3, 7}) {
    DisturbanceObserver observer({t, g, f});
    observer.reset(Vec3::Zero());
    observer.applied(Vec3::Zero(), Mat3::Identity());
    Joint joint;
    joint.v = 0.3;
    std::vector<double> errors;
    for (int i = 1; i <= 8 * apart; ++i) {
      joint.step(-2.0, t);
      observer.update(Vec3::Constant(i % apart == 0 ? joint.q : std::nan("")), i % apart == 0);
      if (i % apart == 0) errors.push_back(observer.disturbance_n()[0] - 2.0);
    }
    const double a = std::exp(-g * t * apart), b = std::exp(-f * t * apart);
    const double s1 = a + 2 * b, s2 = 2 * a * b + b * b, s3 = a * b * b;
    for (std::size_t k = 0; k + 3 < errors.size(); ++k) {
      const double expected = s1 * errors[k + 2] - s2 * errors[k + 1] + s3 * errors[k];
      EXPECT_NEAR(errors[k + 3], expected, 1e-9 * std::abs(errors[0])) << apart << " samples apart";
    }
  }
}

/// Joints at rest on which the accelerations `by` act, one a sample; what the observer takes for the
/// disturbance at the end, m/s^2.
double estimate_after(const std::vector<double>& by, AbruptForce abrupt, int apart = 1) {
  const double t = 1e-3;
  DisturbanceObserver observer(
      {.period_s = t, .bandwidth_rad_per_s = 300, .velocity_bandwidth_rad_per_s = 900, .abrupt = abrupt});
  observer.applied(Vec3::Zero(), Mat3::Identity());
  Joint joint;
  int i = 0;
  for (const double acceleration : by) {
    joint.step(acceleration, t);
    observer.update(Vec3(joint.q, 0, 0), ++i % apart == 0);
  }
  return -observer.disturbance_n()[0];
}

constexpr AbruptForce kAbrupt{.min_m = 3e-6, .max_m = 200e-6};

// 30 m/s^2 at once are 15 um in the first sample.
TEST(DisturbanceObserver, AForceThatComesAtOnceIsKnownAtOnce) {
  EXPECT_NEAR(estimate_after({0, 0, 30}, kAbrupt), 30.0, 1e-9) << "with the first reading after it";
  EXPECT_LT(estimate_after({0, 0, 30, 30}, {}), 8.0) << "by the poles";
  EXPECT_NEAR(estimate_after({0, 0, -30, -30, -30}, kAbrupt), -30.0, 1e-9) << "and stays known";
  EXPECT_NEAR(estimate_after({0, 0, 30, 30, 30, 30}, kAbrupt, 2), 30.0, 1e-9) << "two samples apart";
  // Between two readings: a quarter of it by the first, seven eighths by the second.
  EXPECT_NEAR(estimate_after({0, 0, 0, 30}, kAbrupt, 2), 7.5, 1e-9);
  EXPECT_NEAR(estimate_after({0, 0, 0, 30, 30, 30}, kAbrupt, 2), 26.25, 1e-9);
}

TEST(DisturbanceObserver, WhatIsSmallerOrLargerThanAForceThatComesAtOnceIsAnsweredAsEver) {
  EXPECT_EQ(estimate_after({0, 5.9}, kAbrupt), estimate_after({0, 5.9}, {})) << "2.95 um";
  EXPECT_NEAR(estimate_after({0, 6.1}, kAbrupt), 6.1, 1e-9) << "3.05 um";
  EXPECT_EQ(estimate_after({0, 401}, kAbrupt), estimate_after({0, 401}, {})) << "a slip of the sensor";
  EXPECT_NEAR(estimate_after({0, 399}, kAbrupt), 399, 1e-9);
  EXPECT_EQ(estimate_after({0, 0, 5.9, 5.9}, kAbrupt, 2), estimate_after({0, 0, 5.9, 5.9}, {}, 2))
      << "over two samples four times as much";
}

// Whatever keeps coming is no hand that lets go: a hundred readings are answered as ever in between.
TEST(DisturbanceObserver, ForcesThatComeAtOnceAreAnsweredSoOnceInAHundredAndTwoReadings) {
  std::vector<double> by(101, 30.0);
  by.push_back(60.0);
  EXPECT_LT(estimate_after(by, kAbrupt), 40.0) << "the hundredth reading after the two";
  by.insert(by.begin(), 30.0);
  EXPECT_NEAR(estimate_after(by, kAbrupt), 60.0, 1e-6);
}

TEST(DisturbanceObserver, BridgesMissingReadingsByItsModel) {
  const double t = 1e-3;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  observer.applied(Vec3::Constant(1.0), Mat3::Identity());
  for (int i = 0; i < 200; ++i) {
    joint.step(1.0 - 0.4, t);
    observer.update(Vec3::Constant(joint.q), true);
  }
  for (int i = 0; i < 50; ++i) {
    joint.step(1.0 - 0.4, t);
    observer.update(Vec3::Constant(std::nan("")), false);
  }
  EXPECT_NEAR(observer.joints_m()[0], joint.q, 1e-12);
  EXPECT_NEAR(observer.joint_velocity_m_per_s()[0], joint.v, 1e-12);
}

// The velocity estimate from 0.5 um counts is far quieter than a difference of two counts (0.2 mm/s rms at 1
// kHz).
TEST(DisturbanceObserver, VelocityFromCountsIsQuiet) {
  const double t = 1e-3, count = 0.5e-6;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  joint.v = 0.0123;
  observer.applied(Vec3::Zero(), Mat3::Identity());
  double sum = 0, difference_sum = 0, last = 0;
  const int settle = 100, count_samples = 2000;
  for (int i = 0; i < settle + count_samples; ++i) {
    joint.step(0, t);
    const double measured = std::floor(joint.q / count) * count;
    observer.update(Vec3::Constant(measured), true);
    if (i >= settle) {
      sum += std::pow(observer.joint_velocity_m_per_s()[0] - joint.v, 2);
      difference_sum += std::pow((measured - last) / t - joint.v, 2);
    }
    last = measured;
  }
  EXPECT_LT(std::sqrt(sum / count_samples), 0.6 * std::sqrt(difference_sum / count_samples));
  std::printf("velocity noise: observer %.1f um/s rms, difference %.1f um/s rms\n",
              1e6 * std::sqrt(sum / count_samples), 1e6 * std::sqrt(difference_sum / count_samples));
}

// The plant obeys each force a few samples late: an observer that knows that sees no disturbance in it, one
// that does not takes the change of force for one.
TEST(DisturbanceObserver, AKnownLoopDelayIsNoDisturbance) {
  const double t = 1.0 / 2400.0, mass = 0.4;
  const auto largest = [&](int known_delay) {
    constexpr std::size_t kDelay = 3;
    DisturbanceObserver observer({.period_s = t,
                                  .bandwidth_rad_per_s = 300,
                                  .velocity_bandwidth_rad_per_s = 700,
                                  .loop_delay = static_cast<double>(known_delay)});
    observer.reset(Vec3::Zero());
    Joint joint;
    std::array<double, kDelay + 1> sent{};
    double worst = 0;
    for (int i = 0; i < 500; ++i) {
      for (std::size_t k = kDelay; k > 0; --k) sent[k] = sent[k - 1];
      sent[0] = std::sin(2 * M_PI * 20 * i * t);
      observer.applied(Vec3::Constant(sent[0]), mass * Mat3::Identity());
      joint.step(sent[kDelay] / mass, t);
      observer.update(Vec3::Constant(joint.q), true);
      worst = std::max(worst, std::abs(observer.disturbance_n()[0]));
    }
    return worst;
  };
  EXPECT_LT(largest(3), 1e-9);
  EXPECT_GT(largest(2), 0.02);
  EXPECT_GT(largest(0), 0.06);
}

// Readings a part of a period, or one and a half periods old: no disturbance either, and ahead() is the joint
// of now.
TEST(DisturbanceObserver, ADelayNeedNotBeWholeAndAheadIsThePresent) {
  const double t = 1e-3, mass = 0.4, opposing_n = 0.3;
  for (const double delay : {0.0, 0.3, 1.0, 1.5, 3.75, 4.0}) {
    DisturbanceObserver observer({.period_s = t,
                                  .bandwidth_rad_per_s = 900,
                                  .velocity_bandwidth_rad_per_s = 2700,
                                  .loop_delay = delay});
    observer.reset(Vec3::Zero());
    constexpr int kParts = 20;  // of a period: delays are multiples of it
    const auto late = static_cast<std::size_t>(std::lround(delay * kParts));
    std::vector<Joint> past(1);
    double worst_n = 0.0, worst_m = 0.0, worst_m_per_s = 0.0;
    for (int i = 0; i < 400; ++i) {
      const std::size_t read = past.size() > late ? past.size() - 1 - late : 0;
      observer.update(Vec3::Constant(past[read].q), true);
      const auto now = observer.ahead();
      if (i > 100) {
        worst_n = std::max(worst_n, std::abs(observer.disturbance_n()[0] - opposing_n));
        worst_m = std::max(worst_m, std::abs(now.joints_m[0] - past.back().q));
        worst_m_per_s = std::max(worst_m_per_s, std::abs(now.velocity_m_per_s[0] - past.back().v));
      }
      const double force_n = std::sin(2 * M_PI * 20 * i * t);
      observer.applied(Vec3::Constant(force_n), mass * Mat3::Identity());
      for (int part = 0; part < kParts; ++part) {
        past.push_back(past.back());
        past.back().step((force_n - opposing_n) / mass, t / kParts);
      }
    }
    EXPECT_LT(worst_n, 1e-9) << delay;
    EXPECT_LT(worst_m, 1e-12) << delay;
    EXPECT_LT(worst_m_per_s, 1e-10) << delay;
  }
}

}  // namespace
}  // namespace telekerf::control
