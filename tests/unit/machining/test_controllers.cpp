// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "slave/machining/controller.h"

namespace telekerf::machining {
namespace {

using robot::DeltaKinematics;

/// A circle of 5 mm in the workspace, at constant speed, as a trajectory.
Reference on_circle(double t, double radius = 5e-3, double speed = 20e-3, double climb = 0.0) {
  // A helix when `climb` is not zero: the frame turns in space.
  const double w = speed / std::hypot(radius, climb);
  const double a = w * t;
  Reference r;
  r.position_m = {radius * std::cos(a), radius * std::sin(a), climb * a};
  r.velocity_m_per_s = w * Vec3(-radius * std::sin(a), radius * std::cos(a), climb);
  r.acceleration_m_per_s2 = -w * w * radius * Vec3(std::cos(a), std::sin(a), 0);
  r.speed_m_per_s = speed;
  r.tangent = r.velocity_m_per_s / speed;
  r.tangent_s = r.acceleration_m_per_s2 / (speed * speed);
  r.tangent_ss = w * w * w * radius * Vec3(std::sin(a), -std::cos(a), 0) / (speed * speed * speed);
  return r;
}

TEST(MovingFrame, IsARotationAndItsRatesAreItsDerivatives) {
  for (const double climb : {0.0, 2e-3}) {
    const double h = 1e-4;
    for (double t = 0.0; t < 1.0; t += 0.07) {
      const MovingFrame f = moving_frame(on_circle(t, 5e-3, 20e-3, climb));
      const MovingFrame before = moving_frame(on_circle(t - h, 5e-3, 20e-3, climb));
      const MovingFrame after = moving_frame(on_circle(t + h, 5e-3, 20e-3, climb));
      EXPECT_LT((f.rows * f.rows.transpose() - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(f.rows.determinant(), 1.0, 1e-12);
      EXPECT_LT(((after.rows - before.rows) / (2 * h) - f.rate).norm(), 1e-5);
      EXPECT_LT(((after.rate - before.rate) / (2 * h) - f.rate2).norm(), 1e-4);
    }
  }
}

TEST(MovingFrame, InThePlaneTheNormalIsToTheLeftAndTheBinormalIsUp) {
  const MovingFrame f = moving_frame(on_circle(0.0));
  EXPECT_LT((f.rows.row(1).transpose() - Vec3(-1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((f.rows.row(2).transpose() - Vec3(0, 0, 1)).norm(), 1e-12);
}

/// On a plant that does what it is told (q'' = desired), from an error across the path.
class IdealPlant : public testing::TestWithParam<int> {
 protected:
  robot::RobotModel model = robot::load_robot("slave-keops");
  DeltaKinematics kinematics{model.geometry};
  Vec3 origin = model.in_base(Vec3::Zero());

  /// Errors along, across and up over time, sampled by Runge-Kutta.
  std::vector<Vec3> run(const Controller& controller, const Vec3& offset_in_frame, double duration) {
    std::vector<Vec3> errors;
    const auto start = on_circle(0.0);
    const Vec3 tool = origin + start.position_m - moving_frame(start).rows.transpose() * offset_in_frame;
    Vec3 q = *kinematics.inverse(tool);
    // At the velocity that keeps the offset at rest in the moving frame.
    const Vec3 v = start.velocity_m_per_s - moving_frame(start).rate.transpose() * offset_in_frame;
    Vec3 qd = *kinematics.inverse_jacobian(q, tool) * v;
    const double h = 1e-4;
    const auto slope = [&](double t, const Vec3& at_q, const Vec3& at_qd) {
      const DeltaState state = *kinematics.state(at_q, at_qd);
      const Trajectory trajectory({on_circle(t)});
      // One point at its start: derivatives are kept.
      return desired_acceleration(controller, Tracking{kinematics, state, trajectory, 0.0, origin});
    };
    for (double t = 0.0; t < duration; t += h) {
      const auto r = on_circle(t);
      const Vec3 at = *kinematics.forward(q);
      errors.push_back(moving_frame(r).rows * (origin + r.position_m - at));
      const Vec3 a1 = slope(t, q, qd);
      const Vec3 a2 = slope(t + h / 2, q + h / 2 * qd, qd + h / 2 * a1);
      const Vec3 a3 = slope(t + h / 2, q + h / 2 * qd + h * h / 4 * a1, qd + h / 2 * a2);
      const Vec3 a4 = slope(t + h, q + h * qd + h * h / 2 * a2, qd + h * a3);
      q += h * qd + h * h / 6 * (a1 + a2 + a3);
      qd += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return errors;
  }
};

TEST_F(IdealPlant, ContouringErrorObeysItsLawWithoutCoupling) {
  // Critically damped at 20 1/s across: e = e0 (1 + 20 t) exp(-20 t); nothing along, nothing up.
  ContouringControl control;
  control.bandwidth_rad_s = {10, 20, 20};
  control.acceleration_ahead = 0.0;
  const double e0 = 1e-3;
  const auto errors = run(control, {0, e0, 0}, 0.3);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double t = 1e-4 * static_cast<double>(i);
    EXPECT_NEAR(errors[i][1], e0 * (1 + 20 * t) * std::exp(-20 * t), 1e-9) << t;
    EXPECT_NEAR(errors[i][0], 0.0, 1e-9) << t;
    EXPECT_NEAR(errors[i][2], 0.0, 1e-9) << t;
  }
}

TEST_F(IdealPlant, AllControllersStayOnAPathTheyAreOn) {
  PreviewControl preview;
  preview.acceleration_ahead = 0.0;
  ContouringControl contouring;
  contouring.acceleration_ahead = 0.0;
  for (const Controller& control :
       {Controller(IndependentControl{}), Controller(preview), Controller(contouring)}) {
    for (const Vec3& e : run(control, Vec3::Zero(), 0.2)) EXPECT_LT(e.norm(), 1e-9);
  }
}

TEST_F(IdealPlant, FiniteTimeVariantReachesItsSurfaceSooner) {
  PreviewControl plain;
  plain.acceleration_ahead = 0.0;
  plain.convergence_rad_s = plain.slope_rad_s = 10.0;
  PreviewControl reaching = plain;
  reaching.reaching_m_per_s2 = 0.5;
  const double e0 = 1e-3;
  EXPECT_LT(run(reaching, {0, e0, 0}, 0.2).back().norm(), 0.8 * run(plain, {0, e0, 0}, 0.2).back().norm());
}

TEST(Controllers, AReferenceOutOfReachIsNotFinite) {
  const robot::RobotModel model = robot::load_robot("slave-keops");
  const DeltaKinematics kinematics(model.geometry);
  const Vec3 origin = model.in_base(Vec3::Zero());
  const DeltaState state = *kinematics.state(*kinematics.inverse(origin), Vec3::Zero());
  Reference far;
  far.position_m = {1, 0, 0};
  const Trajectory trajectory({far});
  const Tracking now{kinematics, state, trajectory, 0.0, origin};
  EXPECT_FALSE(desired_acceleration(IndependentControl{}, now).allFinite());
  EXPECT_FALSE(desired_acceleration(PreviewControl{}, now).allFinite());
}

}  // namespace
}  // namespace telekerf::machining
