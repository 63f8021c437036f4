// SPDX-License-Identifier: Apache-2.0
// Estimators and samples at which the slave applied nothing, or applied another master's commands: nothing is
// learnt of what the commands did not do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "master/command_stream.h"

namespace telekerf::master {
namespace {

constexpr double kH = 1e-3;

EstimatorSettings settings_of() {
  EstimatorSettings settings;
  settings.period_s = kH;
  return settings;
}

/// Commands of zero at every index.
void fill(CommandHistory& history, std::int64_t to, const Vec3& command = Vec3::Zero()) {
  KinematicState state;
  state.acceleration_m_per_s2 = command;
  for (std::int64_t index = 0; index < to; ++index) history.store(index, state);
}

SlaveSample off_by(double x_m, std::int64_t index, bool applied) {
  return {index, index, applied, Vec3(x_m, 0, 0), Vec3::Zero()};
}

TEST(ReferenceModelEstimator, LearnsAShareOfWhatAppliedSamplesAreOffAndNothingElse) {
  CommandHistory history;
  fill(history, 100);
  ReferenceModelEstimator estimator(settings_of());
  estimator.reset(10, {});
  const auto learnt_m = [&](double off_m, std::int64_t index, bool applied) {
    estimator.correct(history, off_by(off_m, index, applied), 100);
    return estimator.take_correction_m().x();
  };
  EXPECT_EQ(learnt_m(50e-6, 20, false), 0.0) << "nothing was applied";
  EXPECT_EQ(estimator.innovation_m().x(), 0.0);
  EXPECT_EQ(learnt_m(50e-6, 9, true), 0.0) << "from before it began";
  EXPECT_EQ(learnt_m(50e-6, 100, true), 0.0) << "never sent";
  EXPECT_DOUBLE_EQ(learnt_m(50e-6, 10, true), 0.002 * 50e-6);
  EXPECT_EQ(estimator.innovation_m().x(), 50e-6);
  EXPECT_DOUBLE_EQ(learnt_m(-0.1e-3, 20, true), -0.002 * 0.1e-3);
  EXPECT_DOUBLE_EQ(learnt_m(-0.3e-3, 20, true), -0.002 * 0.1e-3) << "no more than the slave's loop can leave";
  EXPECT_EQ(estimator.take_correction_m().x(), 0.0) << "taken once";
  estimator.correct(history, off_by(50e-6, 20, true), 100);
  estimator.correct(history, off_by(50e-6, 21, true), 100);
  EXPECT_DOUBLE_EQ(estimator.take_correction_m().x(), 0.002 * 100e-6) << "all of a batch";
  estimator.correct(history, off_by(50e-6, 20, true), 100);
  estimator.reset(10, {});
  EXPECT_EQ(estimator.take_correction_m().x(), 0.0);
}

TEST(DelayedInnovation, PullsPositionAndVelocityByItsGainAndIsMovedByWhatTheBlockBecame) {
  CommandHistory history;
  fill(history, 100);
  DelayedInnovation<OpenIntegrator> estimator(settings_of());
  const auto at = [&] { return estimator.predicted_state(history, 100); };
  estimator.reset(10, {});
  for (std::int64_t index = 10; index < 100; ++index) estimator.predict(history, index);
  KinematicState change;
  change.position_m = {1e-3, 2e-3, 3e-3};
  change.velocity_m_per_s = {0.1, 0.2, 0.3};
  estimator.revise(history, 100, change);
  EXPECT_EQ(at().position_m, change.position_m);
  EXPECT_EQ(at().velocity_m_per_s, change.velocity_m_per_s);

  for (const std::int64_t index : {9, 100}) estimator.correct(history, off_by(50e-6, index, true), 100);
  estimator.correct(history, off_by(50e-6, 50, false), 100);
  EXPECT_EQ(at().position_m, change.position_m) << "before it began, never sent, not applied";
  // 1/(e D), D = 50 ms; of what was thought at 50, which was zero.
  const SlaveSample sample{50, 50, true, Vec3(50e-6, 0, 0), Vec3(0, 2e-3, 0)};
  estimator.correct(history, sample, 100);
  const double share = kH / (std::exp(1.0) * 0.05);
  EXPECT_NEAR(at().position_m.x(), 1e-3 + share * 50e-6, 1e-15);
  EXPECT_NEAR(at().velocity_m_per_s.y(), 0.2 + share * 2e-3, 1e-15);
  EXPECT_EQ(estimator.innovation_m().x(), 50e-6);
  // A delay below 20 ms counts as that.
  estimator.correct(history, {95, 95, true, Vec3(50e-6, 0, 0), Vec3::Zero()}, 100);
  EXPECT_NEAR(at().position_m.x(), 1e-3 + share * 50e-6 * (1.0 + 0.05 / 0.02), 1e-15);
}

class Predictor : public testing::Test {
 protected:
  Predictor() {
    fill(history_, 5000);
    predictor_.reset(0, {});
  }
  void correct(double x_m, bool applied, std::int64_t steps = 1) {
    at_ += steps;
    predictor_.correct(history_, off_by(x_m, at_, applied), at_ + 50);
    predictor_.revise(history_, at_ + 50, {});
  }
  double seen_m() { return predictor_.predicted_state(history_, at_ + 50).position_m.x(); }

  CommandHistory history_;
  PropagatedPredictor predictor_{settings_of()};
  std::int64_t at_ = 0;
};

TEST_F(Predictor, LearnsNoDisturbanceFromSamplesAtWhichNothingWasApplied) {
  correct(0.0, true);
  for (int n = 0; n < 100; ++n) correct(50e-6, false);
  EXPECT_EQ(predictor_.disturbance_m_per_s2(), Vec3(Vec3::Zero()));
  EXPECT_GT(seen_m(), 10e-6) << "but the place";
  correct(60e-6, true);
  EXPECT_NE(predictor_.disturbance_m_per_s2().x(), 0.0);
}

/// A gap of 150 ms is bridged by the model, a longer one is not: then the slave is where it is measured.
TEST_F(Predictor, TrustsItsModelOverAGapOfAtMost150Milliseconds) {
  for (const std::int64_t gap : {149, 151}) {
    at_ = 0;
    predictor_.reset(0, {});
    correct(0.0, true);
    correct(1e-3, true, gap);
    const double taken = predictor_.predicted_state(history_, 0).position_m.x();
    EXPECT_EQ(std::abs(taken - 1e-3) < 2e-6, gap > 150) << taken;
  }
  for (const int unapplied : {149, 152}) {
    at_ = 0;
    predictor_.reset(0, {});
    correct(0.0, true);
    for (int n = 0; n < unapplied; ++n) correct(0.0, false);
    correct(1e-3, false);
    const double taken = predictor_.predicted_state(history_, 0).position_m.x();
    EXPECT_EQ(std::abs(taken - 1e-3) < 2e-6, unapplied > 150) << taken;
  }
}

TEST_F(Predictor, TakesTheFirstSampleAsItIsAndSoWhateverGoesBack) {
  correct(1e-3, false);
  EXPECT_NEAR(seen_m(), 1e-3, 1e-12);
  correct(2e-3, false);
  EXPECT_NEAR(seen_m(), 2e-3, 1e-12) << "as long as nothing was applied";
  correct(3e-3, true);
  EXPECT_NEAR(seen_m(), 3e-3, 1e-12);
  correct(4e-3, true);
  EXPECT_LT(seen_m(), 3.9e-3) << "from now on there is a model";
  correct(6e-3, true, -1);
  EXPECT_NEAR(seen_m(), 6e-3, 2e-6) << "back in time";
  at_ = -5;
  correct(9e-3, true);
  EXPECT_NEAR(seen_m(), 6e-3, 2e-6) << "from before it began";
}

/// Poles at 20 rad/s twice and at 1 rad/s: the innovation of a constant disturbance obeys their recursion.
TEST_F(Predictor, ForgetsAtThePolesThatWereAskedFor) {
  double x_m = 0.0;
  double v_m_per_s = 0.0;
  std::vector<double> errors;
  correct(0.0, true);
  for (int n = 0; n < 10; ++n) {
    x_m += kH * v_m_per_s + 0.5 * kH * kH * 0.3;
    v_m_per_s += kH * 0.3;
    correct(x_m, true);
    errors.push_back(predictor_.disturbance_m_per_s2().x() - 0.3);
  }
  const double a = std::exp(-1.0 * kH);
  const double b = std::exp(-20.0 * kH);
  for (std::size_t k = 0; k + 3 < errors.size(); ++k) {
    const double expected =
        (a + 2 * b) * errors[k + 2] - (2 * a * b + b * b) * errors[k + 1] + a * b * b * errors[k];
    EXPECT_NEAR(errors[k + 3], expected, 1e-11);
  }
}

TEST_F(Predictor, BelievesInNoDisturbanceAbove2MetresPerSecondSquared) {
  double x_m = 0.0;
  correct(0.0, true);
  for (int n = 1; n <= 4000; ++n) {
    const double t_s = n * kH;
    x_m = 0.5 * 5.0 * t_s * t_s;
    correct(x_m, true);
    ASSERT_LE(predictor_.disturbance_m_per_s2().norm(), 2.0 + 1e-12);
  }
  EXPECT_NEAR(predictor_.disturbance_m_per_s2().x(), 2.0, 1e-9);
}

TEST(DelayedInnovation, CorrectsByTheGainThatTheDelayAllowsAndByAppliedSamplesOnly) {
  for (const double own_gain : {0.0, 3.0}) {
    for (const std::int64_t delay : {5, 100}) {
      CommandHistory history;
      fill(history, 200, Vec3(0.1, 0, 0));
      EstimatorSettings settings = settings_of();
      settings.innovation_gain_per_s = own_gain;
      DelayedInnovation<OpenIntegrator> estimator(settings);
      KinematicState state{.position_m = Vec3(1e-3, 0, 0), .velocity_m_per_s = Vec3(0.02, 0, 0)};
      estimator.reset(20, state);
      std::vector<KinematicState> past;
      for (std::int64_t index = 20; index < 180; ++index) {
        past.push_back(state);
        estimator.predict(history, index);
        state.acceleration_m_per_s2 = Vec3(0.1, 0, 0);
        state = advanced(state, kH);
      }
      EXPECT_LT((estimator.predicted_state(history, 180).position_m - state.position_m).norm(), 1e-15);
      const auto correct = [&](std::int64_t index, bool applied) {
        const auto& then = past[static_cast<std::size_t>(std::max<std::int64_t>(index, 20) - 20)];
        const SlaveSample sample{index, index, applied, then.position_m + Vec3(50e-6, 0, 0),
                                 then.velocity_m_per_s + Vec3(0, 2e-3, 0)};
        const KinematicState before = estimator.predicted_state(history, 180);
        estimator.correct(history, sample, 180);
        const KinematicState after = estimator.predicted_state(history, 180);
        return std::pair{after.position_m.x() - before.position_m.x(),
                         after.velocity_m_per_s.y() - before.velocity_m_per_s.y()};
      };
      EXPECT_EQ(correct(180 - delay, false).first, 0.0);
      EXPECT_EQ(correct(19, true).first, 0.0) << "from before it began";
      EXPECT_EQ(estimator.innovation_m().x(), 0.0);
      const double gain =
          own_gain > 0.0 ? own_gain : 1.0 / (M_E * std::max(0.02, static_cast<double>(delay) * kH));
      const auto [position_m, velocity_m_per_s] = correct(180 - delay, true);
      EXPECT_NEAR(position_m, gain * kH * 50e-6, 1e-15);
      EXPECT_NEAR(velocity_m_per_s, gain * kH * 2e-3, 1e-15);
      EXPECT_NEAR(estimator.innovation_m().x(), 50e-6, 1e-15);
    }
  }
}

/// A slave that is a millimetre off what the master thinks, and follows it or another one.
class Answers : public testing::TestWithParam<Law> {
 protected:
  static streaming::Feedback feedback(std::span<const SlaveSample> samples, bool ours) {
    streaming::Feedback feedback;
    feedback.kind = streaming::Arrival::Kind::kNew;
    feedback.ours = ours;
    feedback.samples = samples;
    return feedback;
  }
};

TEST_P(Answers, ToAnotherMasterMoveNoIdeaOfTheSlave) {
  const auto moved_m = [&](bool ours) {
    CommandStreamSettings settings;
    settings.law = GetParam();
    settings.codec.anchored = false;
    settings.codec.quantum = 1e-3;
    CommandStream stream(settings, 3);
    const SlaveSample rest{0, 0, false, Vec3::Zero(), Vec3::Zero()};
    stream.received(feedback({&rest, 1}, true));
    const MasterSample master{.tool = {}, .engaged = true};
    Tick tick = 0;
    for (; tick < 64; ++tick) (void)stream.step(0, tick, master);
    for (; tick < 160; ++tick) {
      const auto then = static_cast<std::int64_t>(tick) - 40;
      const SlaveSample off{then, then, true, Vec3(1e-3, 0, 0), Vec3::Zero()};
      stream.received(feedback({&off, 1}, ours));
      (void)stream.step(0, tick, master);
    }
    return stream.observed().slave.position_m.norm();
  };
  EXPECT_LT(moved_m(false), 1e-12);
  EXPECT_GT(moved_m(true), 30e-9) << "the law leads the model back at 400 rad/s";
}

INSTANTIATE_TEST_SUITE_P(Laws, Answers, testing::Values(Law::kAnchored, Law::kRemoteAcceleration));

}  // namespace
}  // namespace telekerf::master
