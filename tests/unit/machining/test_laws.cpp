// SPDX-License-Identifier: Apache-2.0
// The laws of following a path, tick by tick against the equations they are.
#include <gtest/gtest.h>

#include <cmath>

#include "slave/machining/controller.h"
#include "slave/machining/path_follower.h"

namespace telekerf::machining {
namespace {

/// A straight motion along x whose acceleration changes at every tick.
Trajectory straight() {
  std::vector<Reference> points;
  for (int i = 0; i < 5; ++i) {
    Reference r;
    r.position_m = {1e-3 * i, 0.5e-3, 0.0};
    r.velocity_m_per_s = {0.02, 0.0, 0.0};
    r.acceleration_m_per_s2 = {0.1 * (i + 1), 0.0, 0.0};
    r.speed_m_per_s = 0.02;
    points.push_back(r);
  }
  return Trajectory(points);
}

class Laws : public testing::Test {
 protected:
  robot::RobotModel model = robot::load_robot("slave-keops");
  robot::DeltaKinematics kinematics{model.geometry};
  Vec3 origin = model.in_base(Vec3::Zero());
  Trajectory trajectory = straight();

  robot::DeltaState state(const Vec3& tool_m, const Vec3& velocity_m_per_s) const {
    const Vec3 q = *kinematics.inverse(origin + tool_m);
    return *kinematics.state(q, *kinematics.inverse_jacobian(q, origin + tool_m) * velocity_m_per_s);
  }
  JointReference joints(double tick) const {
    const robot::DeltaState at = state(Vec3::Zero(), Vec3::Zero());
    return joint_reference({kinematics, at, trajectory, 0.0, origin}, trajectory.at(tick));
  }
};

TEST_F(Laws, AJointReferenceIsTheToolsThroughTheKinematics) {
  const JointReference q = joints(2.0);
  ASSERT_TRUE(q.good);
  const robot::DeltaState there = *kinematics.state(q.position_m, q.velocity_m_per_s);
  EXPECT_LT((there.tool_m - origin - trajectory[2].position_m).norm(), 1e-12);
  EXPECT_LT((there.tool_velocity_m_per_s - trajectory[2].velocity_m_per_s).norm(), 1e-12);
  EXPECT_LT((there.tool_acceleration(q.acceleration_m_per_s2) - trajectory[2].acceleration_m_per_s2).norm(),
            1e-9);
}

TEST_F(Laws, IndependentJointsObeyEq32) {
  const robot::DeltaState now = state({1.9e-3, 0.6e-3, 0.1e-3}, {0.01, 0.005, 0.0});
  const JointReference q = joints(2.0);
  for (const double ahead : {0.0, 1.5}) {
    const IndependentControl law{.bandwidth_rad_s = 50.0, .damping = 0.8, .acceleration_ahead = ahead};
    const Vec3 expected = joints(2.0 + ahead).acceleration_m_per_s2 +
                          80.0 * (q.velocity_m_per_s - now.joint_velocity_m_per_s) +
                          2500.0 * (q.position_m - now.joints_m);
    EXPECT_LT((law.update({kinematics, now, trajectory, 2.0, origin}) - expected).norm(), 1e-9) << ahead;
  }
}

TEST_F(Laws, PreviewObeysEq32To35) {
  const robot::DeltaState now = state({1.9e-3, 0.6e-3, 0.1e-3}, {0.01, 0.005, 0.0});
  const JointReference q = joints(1.0);
  for (const double reaching : {0.0, 0.5}) {
    const PreviewControl law{.convergence_rad_s = 40.0,
                             .slope_rad_s = 70.0,
                             .velocity_ahead = 1.0,
                             .acceleration_ahead = 2.25,
                             .reaching_m_per_s2 = reaching,
                             .layer_m_per_s = 5e-3};
    const Vec3 v = joints(2.0).velocity_m_per_s - now.joint_velocity_m_per_s;
    const Vec3 e = q.position_m - now.joints_m;
    Vec3 expected = joints(3.25).acceleration_m_per_s2 + 110.0 * v + 2800.0 * e;
    for (int i = 0; i < 3; ++i) expected[i] += reaching * std::clamp((v[i] + 70.0 * e[i]) / 5e-3, -1.0, 1.0);
    EXPECT_LT((law.update({kinematics, now, trajectory, 1.0, origin}) - expected).norm(), 1e-9) << reaching;
  }
}

TEST_F(Laws, ContouringOnAStraightWayHasItsOwnBandwidthAlongAcrossAndUp) {
  ContouringControl law;
  law.bandwidth_rad_s = {30.0, 50.0, 80.0};
  law.damping = {1.0, 0.7, 0.9};
  law.acceleration_ahead = 1.0;
  const Vec3 error(10e-6, -20e-6, 30e-6), rate(1e-3, 2e-3, -3e-3);
  const robot::DeltaState now =
      state(trajectory[2].position_m - error, trajectory[2].velocity_m_per_s - rate);
  const Vec3 wanted(0.4 + 900.0 * error[0] + 60.0 * rate[0], 2500.0 * error[1] + 70.0 * rate[1],
                    6400.0 * error[2] + 144.0 * rate[2]);
  const Vec3 got = law.update({kinematics, now, trajectory, 2.0, origin});
  EXPECT_LT((now.tool_acceleration(got) - wanted).norm(), 1e-9);
}

TEST(Controllers, AutoIsContouringOnAClosedContourAndPreviewOnAnOpenOne) {
  PathFollowerSettings settings;
  settings.loop_delay = 1;
  using Kind = ControllerKind;
  struct Case {
    Kind kind;
    bool closed;
    std::size_t law;
  };
  for (const auto& [kind, closed, law] :
       {Case{Kind::kAuto, true, 2}, Case{Kind::kAuto, false, 1}, Case{Kind::kIndependent, true, 0},
        Case{Kind::kPreview, true, 1}, Case{Kind::kContouring, false, 2}})
    EXPECT_EQ(make_controller(kind, closed, settings).index(), law);
  const PreviewControl preview = PreviewControl::tuned(settings);
  EXPECT_EQ(preview.acceleration_ahead, 1.5)
      << "until the force acts, and half of the sample that it is held";
  EXPECT_EQ(preview.convergence_rad_s, settings.along_rad_s);
  EXPECT_EQ(preview.slope_rad_s, settings.along_rad_s);
  EXPECT_EQ(IndependentControl::tuned(settings).acceleration_ahead,
            settings.independent_model == ModelUse::kNone ? 0.0 : 1.5);
  settings.preview = false;
  EXPECT_EQ(PreviewControl::tuned(settings).acceleration_ahead, 0.0);
  settings.independent_model = ModelUse::kWhole;
  EXPECT_EQ(IndependentControl::tuned(settings).acceleration_ahead, 0.0);
  settings.preview = true;
  EXPECT_EQ(IndependentControl::tuned(settings).acceleration_ahead, 1.5);
}

TEST(Controllers, AreAsFastAsTheirSettingsSay) {
  PathFollowerSettings settings;
  EXPECT_EQ(settings.control_hz, 2400.0);
  EXPECT_EQ(settings.loop_delay, 0);
  EXPECT_EQ(settings.along_rad_s, 70.0);
  EXPECT_EQ(settings.observer_rad_s, 400.0);
  EXPECT_EQ(settings.velocity_rad_s, 900.0);
  settings.loop_delay = 2;
  ContouringControl contouring = ContouringControl::tuned(settings);
  EXPECT_EQ(contouring.bandwidth_rad_s, Vec3(70, 240, 240));
  EXPECT_EQ(contouring.damping, Vec3(1, 1, 1));
  EXPECT_EQ(contouring.acceleration_ahead, 2.5);
  settings.preview = false;
  EXPECT_EQ(ContouringControl::tuned(settings).acceleration_ahead, 0.0);
  EXPECT_EQ(IndependentControl::tuned(settings).bandwidth_rad_s, 70.0);
  EXPECT_EQ(IndependentControl::tuned(settings).damping, 1.0);
  EXPECT_EQ(PreviewControl{}.reaching_m_per_s2, 0.0);
  EXPECT_EQ(PreviewControl{}.velocity_ahead, 0.0);
  const auto joints = joint_settings(ControllerKind::kContouring, settings);
  EXPECT_EQ(joints.observer.period_s, 1.0 / 2400.0);
  EXPECT_EQ(joints.observer.bandwidth_rad_per_s, 400.0);
  EXPECT_EQ(joints.observer.velocity_bandwidth_rad_per_s, 900.0);
  EXPECT_EQ(joints.observer.loop_delay, 2.0);
  EXPECT_FALSE(joints.friction_feedforward);
  EXPECT_EQ(joints.inertia, control::NominalInertia::kModel);
  EXPECT_EQ(joint_settings(ControllerKind::kIndependent, settings).inertia,
            control::NominalInertia::kDiagonal);
}

// A frame that turns fast is not turned along with: from where its second rate is the bandwidth's square on
// less and less, from four times it on not at all.
TEST_F(Laws, ContouringOnATightBendIsAsFastAcrossAsAlongAndLetsTheFrameBe) {
  ContouringControl law;
  law.bandwidth_rad_s = {30.0, 50.0, 80.0};
  law.acceleration_ahead = 0.0;
  const Vec3 error(10e-6, -20e-6, 30e-6), rate(1e-3, 2e-3, -3e-3);
  for (const double turn_rad_s : {20.0, 45.0, 59.0, 61.0, 200.0}) {
    // Round a circle of v / w: the frame's second rate is w^2.
    Reference r;
    r.speed_m_per_s = 0.02;
    const double curvature = turn_rad_s / r.speed_m_per_s;
    r.tangent = Vec3::UnitX();
    r.tangent_s = curvature * Vec3::UnitY();
    r.tangent_ss = -curvature * curvature * Vec3::UnitX();
    r.velocity_m_per_s = 0.02 * Vec3::UnitX();
    const Trajectory one({r});
    const MovingFrame frame = moving_frame(r);
    const double followed = std::clamp(2.0 - std::sqrt(frame.rate2.norm()) / 30.0, 0.0, 1.0);
    const Vec3 w(50.0 - followed * 20.0, 50.0, 80.0);
    const robot::DeltaState now = state(r.position_m - error, r.velocity_m_per_s - rate);
    const Mat3 k1 = w.cwiseAbs2().asDiagonal();
    const Mat3 k2 = (2.0 * w).asDiagonal();
    const Vec3 in_frame = (2.0 * followed * frame.rate + k2 * frame.rows) * rate +
                          (followed * frame.rate2 + followed * k2 * frame.rate + k1 * frame.rows) * error;
    const Vec3 wanted = frame.rows.transpose() * in_frame;
    const Vec3 got = law.update({kinematics, now, one, 0.0, origin});
    EXPECT_LT((now.tool_acceleration(got) - wanted).norm(), 1e-6) << turn_rad_s;
    EXPECT_NEAR(std::sqrt(frame.rate2.norm()), std::pow(2.0, 0.25) * turn_rad_s, 1e-6);
  }
}

TEST(Trajectory, IsReadBetweenItsTicksAndRestsBeyondThem) {
  const Trajectory t = straight();
  EXPECT_EQ(t.at(2.0).position_m, t[2].position_m);
  EXPECT_NEAR(t.at(2.25).position_m.x(), 2.25e-3, 1e-15);
  EXPECT_NEAR(t.at(0.1).position_m.x(), 0.1e-3, 1e-15);
  EXPECT_NEAR(t.at(2.25).acceleration_m_per_s2.x(), 0.325, 1e-15);
  EXPECT_EQ(t.at(4.0).velocity_m_per_s.x(), 0.02) << "the last point itself moves still";
  EXPECT_EQ(t.at(0.0).velocity_m_per_s.x(), 0.02);
  for (const double beyond : {-0.5, 4.5}) {
    EXPECT_EQ(t.at(beyond).velocity_m_per_s.norm(), 0.0);
    EXPECT_EQ(t.at(beyond).acceleration_m_per_s2.norm(), 0.0);
    EXPECT_EQ(t.at(beyond).position_m, t[beyond < 0.0 ? 0 : 4].position_m);
  }
}

}  // namespace
}  // namespace telekerf::machining
