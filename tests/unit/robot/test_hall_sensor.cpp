// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/robot/hall_calibration.h"
#include "common/robot/sensor_noise.h"

namespace telekerf::robot {
namespace {

constexpr double kPitch_m = 0.018;

struct Error {
  double worst = 0;
  double rms = 0;
};

/// Ramp over several pitches and back; error against the truth, with the constant taken out by homing at the
/// start.
Error ramp_error(HallSensor sensor, HallDecoder decoder, double from_m, double to_m,
                 bool remove_mean = false) {
  std::vector<double> errors;
  decoder.update(sensor.sample(from_m));
  decoder.home(from_m);
  constexpr int kSteps = 4000;
  for (int i = 0; i <= 2 * kSteps; ++i) {
    const double share = i <= kSteps ? static_cast<double>(i) / kSteps : 2 - static_cast<double>(i) / kSteps;
    const double d = from_m + share * (to_m - from_m);
    errors.push_back(decoder.update(sensor.sample(d)) - d);
  }
  double mean = 0;
  for (const double e : errors) mean += remove_mean ? e / static_cast<double>(errors.size()) : 0;
  Error error;
  for (const double e : errors) {
    error.worst = std::max(error.worst, std::abs(e - mean));
    error.rms += (e - mean) * (e - mean);
  }
  error.rms = std::sqrt(error.rms / static_cast<double>(errors.size()));
  return error;
}

Sensor hall(double noise, double gain, double offset) {
  Sensor sensor;
  sensor.kind = Sensor::Kind::kHall;
  sensor.pitch_m = kPitch_m;
  sensor.noise = noise;
  sensor.gain_mismatch = gain;
  sensor.offset_mismatch = offset;
  return sensor;
}

std::vector<HallCounts> sweep(HallSensor& sensor, double length_m, int samples) {
  std::vector<HallCounts> counts;
  for (int i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / samples;
    counts.push_back(sensor.sample(length_m * t * t));  // not at constant speed
  }
  return counts;
}

// 16 bits over three channels resolve far better than the pitch / 2^16 of eq. 154.
TEST(HallSensor, IdealChannelsAreQuantisedOnly) {
  const Error error = ramp_error(HallSensor(hall(0, 0, 0), 1), HallDecoder(kPitch_m, 16), 0.001,
                                 0.001 + 0.3 * kPitch_m, true);
  EXPECT_LT(error.worst, 0.065e-6);  // 0.050 um at a full scale of 1; ours is 1.25
  EXPECT_LT(error.rms, 0.028e-6);
}

TEST(HallSensor, UnwrapsOverManyPitchesBothWays) {
  for (const double to : {12.3 * kPitch_m, -12.3 * kPitch_m}) {
    EXPECT_LT(ramp_error(HallSensor(hall(0, 0, 0), 1), HallDecoder(kPitch_m, 16), 0.004, to).worst, 0.15e-6);
  }
}

TEST(HallSensor, FirstReadingLiesInOnePitch) {
  HallSensor sensor(hall(0, 0, 0), 1);
  HallDecoder decoder(kPitch_m, 16);
  const double d = decoder.update(sensor.sample(-0.001));
  EXPECT_NEAR(d, kPitch_m - 0.001, 1e-7);
  EXPECT_NEAR(decoder.amplitude(), 1, 1e-4);
  decoder.home(-0.001);
  EXPECT_NEAR(decoder.update(sensor.sample(0.002)), 0.002, 1e-7);
}

// sigma_phi = sqrt(2/3) sigma_u / A.
TEST(HallSensor, NoiseGoesThroughAsComputed) {
  const double noise = 1e-3;
  const Error error = ramp_error(HallSensor(hall(noise, 0, 0), 2), HallDecoder(kPitch_m, 16), 0, 0.01, true);
  const double expected = std::sqrt(2.0 / 3) * noise * kPitch_m / (2 * std::numbers::pi);
  EXPECT_NEAR(error.rms, expected, 0.03 * expected);
}

TEST(HallSensor, SeveralConversionsHaveTheRootOfTheirNumberLess) {
  for (const int conversions : {4, 16, 64}) {
    Sensor spec = hall(1e-3, 0, 0);
    spec.conversions = conversions;
    const Error error = ramp_error(HallSensor(spec, 2), HallDecoder(kPitch_m, 16), 0, 0.01, true);
    EXPECT_NEAR(error.rms, reading_noise_m(spec), 0.04 * error.rms) << conversions;
    spec.conversions = 1;
    EXPECT_NEAR(error.rms, reading_noise_m(spec) / std::sqrt(conversions), 0.04 * error.rms);
  }
}

TEST(HallSensor, SeveralConversionsAreHalfTheirTimeOld) {
  Sensor spec = hall(0, 0, 0);
  spec.adc_bits = 24;
  spec.conversions = 17;
  spec.conversion_s = 5e-6;
  HallSensor sensor(spec, 1);
  HallDecoder decoder(kPitch_m, 24);
  decoder.update(sensor.sample(0.004));
  EXPECT_NEAR(decoder.update(sensor.sample(0.004, 0.1)), 0.004 - 0.1 * 8 * 5e-6, 1e-9);
  EXPECT_NEAR(decoder.update(sensor.sample(0.004, -0.1)), 0.004 + 0.1 * 8 * 5e-6, 1e-9);
}

TEST(HallSensor, CalibrationTakesMismatchAway) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    Sensor spec = hall(2e-4, 0.02, 0.02);
    spec.phase_mismatch_rad = 0.01;
    const HallAccuracy before = hall_accuracy(spec, 0.04, seed, false);
    const HallAccuracy after = hall_accuracy(spec, 0.04, seed, true);
    EXPECT_GT(before.worst_m, 5e-6);
    EXPECT_LT(after.rms_m, 0.6e-6) << seed;  // 0.47 um is the noise itself
    EXPECT_LT(after.worst_m, 2.5e-6) << seed;
    std::printf(
        "Hall, seed %d: %.1f um worst, %.1f um rms before; %.2f um worst, %.2f um rms after calibration\n",
        static_cast<int>(seed), 1e6 * before.worst_m, 1e6 * before.rms_m, 1e6 * after.worst_m,
        1e6 * after.rms_m);
  }
}

// Known sizes: 1 % of gain in one channel costs up to 9.5 um over a pitch (all gains drawn), 1 % of offset 19
// um.
TEST(HallSensor, UncalibratedErrorHasTheKnownSize) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_LT(hall_accuracy(hall(0, 0.01, 0), 0.036, seed, false).worst_m, 2 * 9.6e-6) << seed;
    EXPECT_LT(hall_accuracy(hall(0, 0, 0.01), 0.036, seed, false).worst_m, 2 * 19.2e-6) << seed;
  }
}

// Without noise the estimates are exact up to the converter: gains and offsets of the channels are found.
TEST(HallSensor, CalibrationFindsTheChannels) {
  Sensor spec = hall(0, 0.05, 0.05);
  spec.adc_bits = 24;
  spec.phase_mismatch_rad = 0.03;
  HallSensor sensor(spec, 11);
  const auto calibration = calibrate_hall(sweep(sensor, 3 * kPitch_m, 3000), 24);
  ASSERT_TRUE(calibration.has_value());
  // Each channel's extremes over a pitch are offset -+ gain.
  std::array<double, 3> low{2, 2, 2}, high{-2, -2, -2};
  Eigen::Vector3d top_rad = Eigen::Vector3d::Zero();  // where each channel is largest
  for (int i = 0; i < 36000; ++i) {
    const auto counts = sensor.sample(kPitch_m * i / 36000);
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = counts[k] * kHallFullScale / (1 << 23);
      low[k] = std::min(low[k], u);
      if (u > high[k]) top_rad[static_cast<int>(k)] = 2 * std::numbers::pi * i / 36000;
      high[k] = std::max(high[k], u);
    }
  }
  // The largest value of sin(phi + phase) stands at pi/2 - phase; the mean phase cannot be seen.
  Eigen::Vector3d phase;
  for (int k = 0; k < 3; ++k) {
    const double nominal = (k == 0 ? 0.0 : k == 1 ? 2.0 : -2.0) * std::numbers::pi / 3;
    phase[k] = std::remainder(std::numbers::pi / 2 - top_rad[k] - nominal, 2 * std::numbers::pi);
  }
  phase.array() -= phase.mean();
  EXPECT_GT(phase.cwiseAbs().maxCoeff(), 1e-3);
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    EXPECT_NEAR(calibration->offset[k], 0.5 * (high[i] + low[i]), 1e-5);
    EXPECT_NEAR(calibration->gain[k], 0.5 * (high[i] - low[i]), 1e-5);
    EXPECT_NEAR(calibration->phase_rad[k], phase[k], 1e-3);
  }
}

TEST(HallSensor, CalibrationRefusesShortSweeps) {
  HallSensor sensor(hall(0, 0.02, 0.02), 1);
  EXPECT_FALSE(calibrate_hall(sweep(sensor, 2 * kPitch_m, 10), 16).has_value());
  EXPECT_FALSE(calibrate_hall(sweep(sensor, 0.3 * kPitch_m, 1000), 16).has_value());
  EXPECT_FALSE(calibrate_hall(std::vector<HallCounts>(100, HallCounts{}), 16).has_value());
}

}  // namespace
}  // namespace telekerf::robot
