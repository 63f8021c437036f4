// SPDX-License-Identifier: Apache-2.0
// The estimators against their analytic limits, on exact double integrators: docs/reference/streaming.md,
// "Limits".
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "common/protocol/wire_precision.h"
#include "master/command_stream.h"

namespace telekerf::master {
namespace {

constexpr double kH = 1e-3;
const double kPi = std::numbers::pi;

ObserverSettings with(const std::string& estimator) {
  ObserverSettings settings;
  settings.estimator = estimator_named(estimator);
  settings.period_s = kH;
  return settings;
}

/// q'' = u + d, exactly: the slave behind a constant delay of `delay` samples, there and back together.
struct Loop {
  NetworkObserver observer;
  int delay = 100;
  int misjudged = 0;  ///< samples by which the acknowledgement is wrong: a predictor that guesses its delay
  double disturbance = 0.0;
  std::vector<KinematicState> truth{KinematicState{}};
  KinematicState model;

  Loop(const ObserverSettings& settings, int samples)
      : observer(Law::kRemoteAcceleration, settings), delay(samples) {
    observer.reset(0, KinematicState{});
  }
  KinematicState predicted() {
    const auto k = static_cast<std::int64_t>(truth.size()) - 1;
    if (k >= delay) {
      const KinematicState& then = truth[static_cast<std::size_t>(k - delay)];
      const SlaveSample sample{k - delay + misjudged, k, true, then.position_m, then.velocity_m_per_s};
      observer.correct(std::span(&sample, 1));
    }
    return observer.predicted_state(model);
  }
  void apply(double u) {
    const auto k = static_cast<std::int64_t>(truth.size()) - 1;
    observer.predict(k, model, Vec3(u, 0, 0));
    KinematicState now = truth.back();
    now.acceleration_m_per_s2 = Vec3(u + disturbance, 0, 0);
    truth.push_back(advanced(now, kH));
  }
  double error(const KinematicState& predicted) const {
    return std::abs(predicted.position_m.x() - truth.back().position_m.x());
  }
};

/// Largest value of `signal` over the first and the last fifth of a run, as a ratio: below 1 it decays.
double growth(int steps, const std::function<double()>& signal) {
  double early = 0.0;
  double late = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double size = std::abs(signal());
    if (i > steps / 5 && i <= 2 * steps / 5) early = std::max(early, size);
    if (i > 4 * steps / 5) late = std::max(late, size);
  }
  return late / early;
}

double delayed_innovation_growth(double gain_times_delay) {
  ObserverSettings settings = with("delayed-innovation");
  settings.innovation_gain_per_s = gain_times_delay / 0.1;
  Loop loop(settings, 100);
  loop.truth.back().position_m.x() = 0.01;
  return growth(60'000, [&] {
    const double error = loop.error(loop.predicted());
    loop.apply(0.0);
    return error;
  });
}

TEST(NetworkObserver, DelayedInnovationIsStableBelowHalfPiOnly) {
  EXPECT_LT(delayed_innovation_growth(0.98 * kPi / 2), 0.5);
  EXPECT_GT(delayed_innovation_growth(1.02 * kPi / 2), 2.0);
}

double tracking_growth(Loop& loop, double w, int steps) {
  loop.truth.back().position_m.x() = 0.01;
  return growth(steps, [&] {
    const KinematicState seen = loop.predicted();
    loop.apply(-2.0 * w * seen.velocity_m_per_s.x() - w * w * seen.position_m.x());
    return loop.truth.back().position_m.x();
  });
}

TEST(NetworkObserver, WithoutPredictionTheLawIsStableBelow06475Only) {
  Loop below(with("none"), 100);
  EXPECT_LT(tracking_growth(below, 0.98 * 0.6475 / 0.1, 60'000), 0.5);
  Loop above(with("none"), 100);
  EXPECT_GT(tracking_growth(above, 1.02 * 0.6475 / 0.1, 60'000), 2.0);
}

/// The slave moves at 20 mm/s; its play-out waits at tick 1500 (a command twice) and skips at 1700 (one not
/// at all); 30 measurements are lost around each. Largest prediction error after the first second.
TEST(NetworkObserver, APlayOutThatWaitsOrSkipsAndLostMeasurementsCostAlmostNothing) {
  NetworkObserver observer(Law::kRemoteAcceleration, with("predictor"));
  observer.reset(0, KinematicState{});
  constexpr int kDelay = 60;
  std::vector<KinematicState> truth{{.velocity_m_per_s = Vec3(0.02, 0, 0)}};
  std::vector<std::int64_t> applied;
  const auto command = [](std::int64_t i) {
    return Vec3(0.3 * std::sin(0.01 * static_cast<double>(i)), 0, 0);
  };
  double largest = 0.0;
  for (std::int64_t k = 0; k < 3000; ++k) {
    const auto untold = [&](std::int64_t event) { return k >= event && k < event + kDelay + 15; };
    const std::int64_t index = k <= 1500 ? k : k <= 1700 ? k - 1 : k;
    applied.push_back(index);
    observer.predict(k, KinematicState{}, command(k));
    const std::int64_t then = k - kDelay;
    const bool lost = std::abs(then - 1500) < 15 || std::abs(then - 1700) < 15;
    if (then >= 0 && !lost) {
      const KinematicState& state = truth[static_cast<std::size_t>(then)];
      const SlaveSample sample{applied[static_cast<std::size_t>(then)], then, true, state.position_m,
                               state.velocity_m_per_s};
      observer.correct(std::span(&sample, 1));
    }
    const KinematicState predicted = observer.predicted_state(KinematicState{});
    if (k > 1000 && !untold(1500) && !untold(1700)) {
      // Where the slave is when the command after this one acts, without waiting or skipping meanwhile.
      KinematicState ahead = truth.back();
      for (std::int64_t i = index; i <= k; ++i) {
        ahead.acceleration_m_per_s2 = command(i);
        ahead = advanced(ahead, kH);
      }
      largest = std::max(largest, (predicted.position_m - ahead.position_m).norm());
    }
    KinematicState now = truth.back();
    now.acceleration_m_per_s2 = command(index);
    truth.push_back(advanced(now, kH));
  }
  EXPECT_LT(largest, 60e-6) << "a wrong step of time would be 20 um at once and grow with the delay";
}

TEST(NetworkObserver, ThePredictorIsExactFromAnyInitialStateUnderAnyConstantDisturbance) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const int delay : {1, 20, 137, 800}) {
    Loop loop(with("predictor"), delay);
    loop.disturbance = 0.05 * uniform(random);
    loop.truth.back().position_m.x() = 0.01 * uniform(random);
    loop.truth.back().velocity_m_per_s.x() = 0.05 * uniform(random);
    double worst = 0.0;
    for (int k = 0; k < 50'000; ++k) {
      const double error = loop.error(loop.predicted());
      if (k > 45'000) worst = std::max(worst, error);
      loop.apply(0.2 * std::sin(0.02 * k) - loop.disturbance);
    }
    EXPECT_LT(worst, 1e-9) << "delay of " << delay << " samples";
  }
}

TEST(NetworkObserver, AMisjudgedDelayIsStableWithinTheRule) {
  // |delta| (2 w + w^2 D) < 1 is sufficient for a predictor that guesses its delay.
  ObserverSettings settings = with("predictor");
  settings.predictor_rad_s = 1e6;  // takes each measurement as it is: the plain predictor of the rule
  settings.disturbance_rad_s = 0.0;
  for (const double w : {5.0, 10.0, 20.0}) {
    const double bound_s = 1.0 / (2.0 * w + w * w * 0.1);
    for (const double sign : {-1.0, 1.0}) {
      Loop loop(settings, 100);
      loop.misjudged = static_cast<int>(sign * 0.95 * bound_s / kH);
      EXPECT_LT(tracking_growth(loop, w, 20'000), 0.5) << "w " << w << ", " << loop.misjudged << " samples";
    }
    Loop far(settings, 100);
    far.misjudged = -std::min(99, static_cast<int>(3.0 * bound_s / kH));
    if (far.misjudged > -99) {
      EXPECT_GT(tracking_growth(far, w, 20'000), 2.0) << "w " << w << ", " << far.misjudged << " samples";
    }
  }
}

TEST(NetworkObserver, TheThesisEstimatorNeedsItsInitialStateThePredictorDoesNot) {
  const auto largest_late_error = [](const std::string& estimator, bool wrong) {
    Loop loop(with(estimator), 100);
    if (wrong) {
      loop.truth.back().position_m.x() = 0.01;
      loop.truth.back().velocity_m_per_s.x() = 0.05;
    }
    double worst = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      const double error = loop.error(loop.predicted());
      if (k > 15'000) worst = std::max(worst, error);
      loop.apply(0.2 * std::sin(0.02 * k));
    }
    return worst;
  };
  EXPECT_LT(largest_late_error("thesis", false), 1e-3);
  EXPECT_GT(largest_late_error("thesis", true), 0.5) << "0.05 m/s for twenty seconds";
  EXPECT_LT(largest_late_error("predictor", true), 1e-6);
  EXPECT_LT(largest_late_error("thesis-window", true), 1e-9);
  const double left_m = largest_late_error("thesis", false);
  EXPECT_NEAR(largest_late_error("thesis-convergent", true), left_m, 0.5 * left_m)
      << "of the wrong start nothing is left, of the low-pass as much as ever";
}

TEST(NetworkObserver, TheWindowForgetsAWrongStartWithinTwoDelaysAndLeavesABiasOfHalfDSquared) {
  for (const double disturbance : {0.0, 0.05}) {
    Loop loop(with("thesis-window"), 100);
    loop.truth.back().position_m.x() = 0.01;
    loop.truth.back().velocity_m_per_s.x() = 0.05;
    loop.disturbance = disturbance;
    for (int k = 0; k < 400; ++k) {
      const KinematicState predicted = loop.predicted();
      if (k < 100) {
        EXPECT_GT(loop.error(predicted), 0.009) << "nothing has been heard yet";
      }
      if (k > 200) {
        // The velocity misses d over one delay; so did each velocity in the position's window.
        EXPECT_NEAR(loop.truth.back().velocity_m_per_s.x() - predicted.velocity_m_per_s.x(),
                    0.1 * disturbance, 1e-12);
        EXPECT_NEAR(loop.truth.back().position_m.x() - predicted.position_m.x(), 0.01 * disturbance,
                    0.005 * 0.01 * disturbance + 1e-12);
      }
      loop.apply(0.2 * std::sin(0.02 * k));
    }
  }
}

/// A resting slave that this master may engage.
StateBlock resting_state(std::uint32_t master_epoch) {
  codec::BlockEncoder encoder{codec::StreamSettings{}};
  StateBlock state;
  state.sequence = 1;
  state.master_epoch = master_epoch;
  state.sample_period_ns = 1'000'000;
  const std::vector<Vec3> samples(16, Vec3::Zero());
  state.payload.size =
      static_cast<std::uint16_t>(encoder.encode(samples, 0, {}, state.payload.room()).value_or(0));
  return state;
}

class CodecAndPrediction : public testing::TestWithParam<Law> {};

TEST_P(CodecAndPrediction, TheCodecAddsNothingToThePredictionError) {
  CommandStreamSettings settings;
  settings.law = GetParam();
  settings.codec.anchored = false;
  settings.codec.quantum = 1e-3;
  settings.codec.keep = 2;  // coarse on purpose
  CommandStream stream(settings, 3);
  streaming::StateReceiver feedback(0.5, 3, 1);
  stream.received(feedback.receive({resting_state(3), 0}));
  codec::BlockDecoder decoder;
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 0.5);
  KinematicState slave;
  double coded_away = 0.0;
  std::vector<double> made;
  for (Tick tick = 0; tick < Tick{16} * 300; ++tick) {
    const double t = static_cast<double>(tick) * kH;
    MasterSample master;
    master.engaged = true;
    master.tool.position_m = Vec3(0.01 * std::sin(3 * t), 0.01 * std::cos(2 * t), 0.0);
    master.tool.velocity_m_per_s = Vec3(0.03 * std::cos(3 * t), -0.02 * std::sin(2 * t), 0.0);
    master.tool.acceleration_m_per_s2 = Vec3(noise(random), noise(random), 0.0);
    const auto block = stream.step(0, tick, master);
    if (tick % 16 == 0) {
      // What the model says where a block begins is where the decoded commands have brought the slave.
      EXPECT_EQ(stream.observed().slave.position_m, slave.position_m) << "tick " << tick;
      EXPECT_EQ(stream.observed().slave.velocity_m_per_s, slave.velocity_m_per_s) << "tick " << tick;
    }
    if (!block) continue;
    const auto packet = decoder.decode(block->payload.view(), {});
    ASSERT_TRUE(packet.has_value());
    if (GetParam() == Law::kAnchored) {
      EXPECT_LT((block->anchor.position_m - slave.position_m).norm(), 4e-9);
      slave = KinematicState{block->anchor.position_m, block->anchor.velocity_m_per_s, Vec3::Zero()};
    }
    for (const Vec3& command : (*packet)->blocks_newest_first[0].samples) {
      slave.acceleration_m_per_s2 = command;
      slave = advanced(slave, kH);
    }
    if (GetParam() == Law::kAnchored) {
      const Anchor next = to_wire_precision(Anchor{slave.position_m, slave.velocity_m_per_s});
      slave.position_m = next.position_m;
      slave.velocity_m_per_s = next.velocity_m_per_s;
    }
    coded_away = std::max(coded_away, slave.velocity_m_per_s.norm());
  }
  EXPECT_GT(coded_away, 0.01) << "it did move";
}

INSTANTIATE_TEST_SUITE_P(Laws, CodecAndPrediction, testing::Values(Law::kAnchored, Law::kRemoteAcceleration));

}  // namespace
}  // namespace telekerf::master
