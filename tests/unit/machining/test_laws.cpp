// SPDX-License-Identifier: Apache-2.0
// The laws of following a path, tick by tick against the equations they are.
#include <gtest/gtest.h>

#include <cmath>

#include "slave/machining/controller.h"

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

TEST(Trajectory, IsReadBetweenItsTicksAndRestsBeyondThem) {
  const Trajectory t = straight();
  EXPECT_EQ(t.at(2.0).position_m, t[2].position_m);
  EXPECT_NEAR(t.at(2.25).position_m.x(), 2.25e-3, 1e-15);
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
