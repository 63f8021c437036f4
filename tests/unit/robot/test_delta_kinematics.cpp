// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "common/robot/delta_kinematics.h"
#include "tests/unit/allocations.h"
#include "tests/unit/robot/machines.h"

namespace telekerf::robot {
namespace {

using namespace testing;
using Kind = KinematicsError::Kind;

constexpr double kMm = 1e-3;

/// Turns `tool` into where the machine can be: in front of the carriages by about one rod.
Vec3 middle(const DeltaGeometry& g) { return {0, 0, g.assembly_mode == AssemblyMode::kAbove ? .1 : -.1}; }

struct Pose {
  Vec3 joints;
  Vec3 tool;
};

/// Random reachable poses whose condition number is below `worst`.
template <typename Visit>
void sweep(const DeltaGeometry& g, int count, double worst, std::uint64_t seed, Visit visit) {
  const DeltaKinematics kinematics(g);
  std::mt19937_64 random(seed);
  int found = 0;
  for (int attempt = 0; attempt < 100 * count && found < count; ++attempt) {
    const Vec3 tool = random_in_box(random, middle(g), 0.3);
    const auto joints = kinematics.inverse(tool);
    if (!joints || !(kinematics.conditioning(*joints, tool).condition < worst)) continue;
    ++found;
    visit(kinematics, Pose{*joints, tool});
  }
  ASSERT_EQ(found, count);
}

TEST(DeltaKinematics, ForwardAndInverseAreInversesOnAllKinds) {
  for (const auto& machine : machines()) {
    const auto& name = machine.name;
    const auto& geometry = machine.geometry;
    double worst_tool = 0;
    double worst_joint = 0;
    Vec3 worst_pose = Vec3::Zero();
    sweep(geometry, 20000, 50, 1, [&](const DeltaKinematics& kinematics, const Pose& pose) {
      const auto tool = kinematics.forward(pose.joints);
      ASSERT_TRUE(tool.has_value()) << name << " " << pose.joints.transpose();
      const auto joints = kinematics.inverse(*tool);
      ASSERT_TRUE(joints.has_value());
      const double error = (*tool - pose.tool).norm();
      if (error > worst_tool) worst_pose = pose.tool;
      worst_tool = std::max(worst_tool, error);
      worst_joint = std::max(worst_joint, (*joints - pose.joints).norm());
    });
    RecordProperty(std::string(name) + "_fk_ik_m", std::to_string(worst_tool * 1e15) + "e-15");
    EXPECT_LE(worst_tool, 1e-12) << name << " at " << worst_pose.transpose();
    EXPECT_LE(worst_joint, 1e-12) << name;
    std::printf("%-11s FK(IK(x)) - x: %.1e m, IK(FK(d)) - d: %.1e m\n", name, worst_tool, worst_joint);
  }
}

// Eq. 102 in its plainest form: proves the corrected lambda (eq. 110) and mu (eq. 134) for unequal rods.
TEST(DeltaKinematics, RodsKeepTheirLength) {
  for (const auto& machine : machines()) {
    const auto& geometry = machine.geometry;
    sweep(geometry, 2000, 50, 2, [&](const DeltaKinematics& kinematics, const Pose& pose) {
      const auto tool = kinematics.forward(pose.joints);
      ASSERT_TRUE(tool.has_value());
      for (int i = 0; i < 3; ++i) {
        const double theta = geometry.rail_angle_rad[i];
        const Vec3 joint = *tool + geometry.tool_radius_m * Vec3(std::cos(theta), std::sin(theta), 0);
        EXPECT_NEAR((joint - kinematics.carriage(i, pose.joints[i])).norm(), geometry.rod_length_m[i], 1e-12);
      }
    });
  }
}

TEST(DeltaKinematics, ReferenceRows) {
  struct Row {
    DeltaGeometry geometry;
    Vec3 tool;
    Vec3 joints;
  };
  const Row rows[] = {
      {horizontal(), {0, 0, .12}, {0, 0, 0}},  // 3-4-5 triangle
      {horizontal(), {.01, -.005, .12}, {0.00555728090000841, 0.00664517860464835, -0.0111577610599237}},
      {keops(), {0, 0, .09}, Vec3::Constant(0.0180956624983221)},
      {keops(), {.01, -.005, .09}, {0.0214530003344887, 0.0220073013575662, 0.0125316797876705}},
      {vertical(), {.01, -.005, .35}, {0.123339460867137, 0.123851930823119, 0.116318484240689}},
      {asymmetric(), {.01, -.005, .09}, {0.0247337850502172, 0.0175286287551147, 0.000388759282236417}},
  };
  for (const auto& row : rows) {
    const DeltaKinematics kinematics(row.geometry);
    EXPECT_LT((*kinematics.inverse(row.tool) - row.joints).norm(), 1e-15) << row.tool.transpose();
    EXPECT_LT((*kinematics.forward(row.joints) - row.tool).norm(), 1e-13) << row.tool.transpose();
  }
}

TEST(DeltaKinematics, LinuxCncPublishedVertical) {
  const DeltaKinematics machine(linuxcnc(269 * kMm, 130.25 * kMm, {90, 210, 330}));
  const Vec3 a = *machine.inverse(Vec3(30, -20, 10) * kMm) / kMm;
  EXPECT_LT((a - Vec3(231.101645177054, 233.456816788892, 261.930399179169)).cwiseAbs().maxCoeff(), 1e-9);
  const Vec3 b = *machine.inverse(Vec3(-50, 40, 5.5) * kMm) / kMm;
  EXPECT_LT((b - Vec3(253.926925875598, 245.011833495325, 192.063545784560)).cwiseAbs().maxCoeff(), 1e-9);
  const DeltaKinematics other(linuxcnc(215 * kMm, 105.6 * kMm, {210, 330, 90}));
  const Vec3 c = *other.forward(Vec3(180, 220, 240) * kMm) / kMm;
  EXPECT_LT((c - Vec3(35.684357435477, 44.992625530342, 36.829202899847)).cwiseAbs().maxCoeff(), 1e-9);
}

// Eq. 136 loses digits when mu_1^2 >> mu_2; ours does not: compared with eq. 135-137 in long double.
TEST(DeltaKinematics, InverseKeepsItsDigits) {
  sweep(asymmetric(), 5000, 50, 3, [&](const DeltaKinematics& kinematics, const Pose& pose) {
    const auto& g = kinematics.geometry();
    for (int i = 0; i < 3; ++i) {
      const long double ct = std::cos(static_cast<long double>(g.rail_angle_rad[i]));
      const long double st = std::sin(static_cast<long double>(g.rail_angle_rad[i]));
      const long double ca = std::cos(static_cast<long double>(g.attack_angle_rad[i]));
      const long double sa = std::sin(static_cast<long double>(g.attack_angle_rad[i]));
      const long double x = pose.tool.x(), y = pose.tool.y(), z = pose.tool.z();
      const long double r = static_cast<long double>(g.tool_radius_m) - g.base_radius_m;
      const long double l = g.rod_length_m[i];
      const long double mu1 = 2 * ca * (r + ct * x + st * y) - 2 * sa * z;
      const long double mu2 = -l * l + x * x + y * y + z * z + r * (r + 2 * ct * x + 2 * st * y);
      const long double exact = (-mu1 - std::sqrt(mu1 * mu1 - 4 * mu2)) / 2;
      EXPECT_NEAR(pose.joints[i], static_cast<double>(exact), 2e-15);
    }
  });
}

// The minus root is a working mode: f_di = -sqrt(Delta_i) / 2 < 0; random joints of an uneven machine may
// stand on the other one, and both modes are reproduced when asked for.
TEST(DeltaKinematics, WorkingModesAreTheSignOfFd) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> stroke(-.05, .08);
  int other_branch = 0;
  for (int k = 0; k < 10000; ++k) {
    DeltaGeometry g = asymmetric();
    const Vec3 joints(stroke(random), stroke(random), stroke(random));
    const auto tool = DeltaKinematics(g).forward(joints);
    if (!tool) continue;
    g.working_mode = DeltaKinematics(g).working_mode_at(joints, *tool);
    if (g.working_mode != std::array<int, 3>{1, 1, 1}) ++other_branch;
    const DeltaKinematics kinematics(g);
    if (kinematics.conditioning(joints, *tool).condition > 50) continue;
    const auto back = kinematics.inverse(*tool);
    ASSERT_TRUE(back.has_value()) << joints.transpose();
    EXPECT_LT((*back - joints).norm(), 1e-12) << joints.transpose();
  }
  EXPECT_GT(other_branch, 100);
}

TEST(DeltaKinematics, JacobianIsTheDerivative) {
  for (const auto& machine : machines()) {
    const auto& name = machine.name;
    const auto& geometry = machine.geometry;
    double worst = 0;
    sweep(geometry, 2000, 50, 5, [&](const DeltaKinematics& kinematics, const Pose& pose) {
      const Mat3 jacobian = *kinematics.jacobian(pose.joints, pose.tool);
      // Near a singular pose curvature grows like the fourth power of the distance: the step shrinks with it.
      const double h = 1e-5 * std::pow(kinematics.conditioning(pose.joints, pose.tool).distance(), 1.5);
      Mat3 difference;
      for (int i = 0; i < 3; ++i) {
        const Vec3 step = h * Vec3::Unit(i);
        const auto f = [&](double n) { return *kinematics.forward(pose.joints + n * step); };
        difference.col(i) = (8 * (f(1) - f(-1)) - (f(2) - f(-2))) / (12 * h);
      }
      worst = std::max(worst, (jacobian - difference).norm() / jacobian.norm());
      const Mat3 inverse = *kinematics.inverse_jacobian(pose.joints, pose.tool);
      EXPECT_LT((inverse * jacobian - Mat3::Identity()).norm(), 1e-9) << name;
    });
    EXPECT_LE(worst, 1e-6) << name;
    std::printf("%-11s Jacobian against differences: %.1e relative\n", name, worst);
  }
}

TEST(DeltaKinematics, JacobianRateIsTheDerivativeAlongTheMotion) {
  for (const auto& machine : machines()) {
    const auto& name = machine.name;
    const auto& geometry = machine.geometry;
    double worst = 0;
    std::mt19937_64 random(6);
    sweep(geometry, 2000, 50, 7, [&](const DeltaKinematics& kinematics, const Pose& pose) {
      const Vec3 qd = random_in_box(random, Vec3::Zero(), 0.2);
      const Vec3 xd = *kinematics.jacobian(pose.joints, pose.tool) * qd;
      const Mat3 rate = *kinematics.jacobian_rate(pose.joints, pose.tool, qd, xd);
      const double h = 1e-4 * std::pow(kinematics.conditioning(pose.joints, pose.tool).distance(), 1.5);
      const auto j = [&](double n) {
        const Vec3 joints = pose.joints + n * h * qd;
        return *kinematics.jacobian(joints, *kinematics.forward(joints));
      };
      const Mat3 difference = (8 * (j(1) - j(-1)) - (j(2) - j(-2))) / (12 * h);
      worst = std::max(worst, (rate - difference).norm() / rate.norm());
    });
    EXPECT_LE(worst, 1e-6) << name;
    std::printf("%-11s Jacobian rate against differences: %.1e relative\n", name, worst);
  }
}

TEST(DeltaKinematics, AccelerationsMapBothWays) {
  const DeltaKinematics kinematics(keops());
  const Vec3 joints = *kinematics.inverse({.01, -.005, .09});
  const Vec3 qd(.1, -.2, .15);
  const Vec3 qdd(1, 2, -3);
  const DeltaState state = *kinematics.state(joints, qd);
  EXPECT_LT((state.joint_acceleration(state.tool_acceleration(qdd)) - qdd).norm(), 1e-12);
  // Against the second difference of the tool's path.
  const double h = 1e-4;
  const auto x = [&](double t) { return *kinematics.forward(joints + t * qd + 0.5 * t * t * qdd); };
  const Vec3 difference = (x(h) - 2 * x(0) + x(-h)) / (h * h);
  EXPECT_LT((state.tool_acceleration(qdd) - difference).norm(), 1e-5 * difference.norm());
}

TEST(DeltaKinematics, ErrorsSayWhichLegAndWhy) {
  DeltaGeometry g = horizontal();
  g.stroke_min_m = -.04;
  g.stroke_max_m = .04;
  const DeltaKinematics kinematics(g);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Vec3& bad : {Vec3(nan, 0, 0), Vec3(0, inf, 0), Vec3(0, 0, -inf)}) {
    EXPECT_EQ(kinematics.forward(bad).error().kind, Kind::kNotFinite);
    EXPECT_EQ(kinematics.inverse(bad).error().kind, Kind::kNotFinite);
    EXPECT_FALSE(kinematics.jacobian(bad, bad).has_value());
    EXPECT_FALSE(kinematics.inverse_jacobian(bad, bad).has_value());
    EXPECT_FALSE(kinematics.state(bad, bad).has_value());
  }
  EXPECT_EQ(kinematics.inverse({0, 0, 1}).error().kind, Kind::kUnreachable);
  EXPECT_EQ(kinematics.forward({0, .041, 0}).error(), (KinematicsError{Kind::kOutOfStroke, 1, .041, .04}));
  EXPECT_EQ(kinematics.forward({0, 0, -.05}).error().leg, 2);
  const auto low = kinematics.inverse({0, .045, .12});  // towards leg 1's rail
  ASSERT_FALSE(low.has_value());
  EXPECT_EQ(low.error().kind, Kind::kOutOfStroke);
  EXPECT_EQ(describe(low.error()).substr(0, 6), "leg " + std::to_string(low.error().leg + 1) + " ");
  // The mirror image below the rails has the same joints, and the machine is not built there.
  EXPECT_EQ(kinematics.inverse({0, 0, -.12}).error().kind, Kind::kOtherAssembly);
}

TEST(DeltaKinematics, ForwardRefusesSpheresThatDoNotMeet) {
  DeltaGeometry g = horizontal();
  g.rod_length_m[1] = 0.05;
  const auto tool = DeltaKinematics(g).forward({-.05, -.05, -.05});
  ASSERT_FALSE(tool.has_value());
  EXPECT_EQ(tool.error().kind, Kind::kUnreachable);
  EXPECT_EQ(tool.error().leg, 1);
  EXPECT_GT(tool.error().value_m, 0);
}

// Appendix B, exactly: det A = 0 iff the three carriage points lie on one line in the xy projection.
TEST(DeltaKinematics, CollinearCarriagesAreSingular) {
  const DeltaGeometry g = machine(.1, .0, {.15, .15, .15}, {0, 120, 240}, {0, 0, 0});
  // Leg 1 at x = -0.05, where the other two carriages are as well.
  const auto tool = DeltaKinematics(g).forward({.15, 0, 0});
  ASSERT_FALSE(tool.has_value());
  EXPECT_EQ(tool.error().kind, Kind::kParallelSingular);
}

// Type 1: as a rod becomes square to its rail its f_di goes to 0, and only J^-1 is lost.
TEST(DeltaKinematics, SerialSingularityIsSeenAndNamed) {
  const DeltaKinematics kinematics(vertical());
  const double reach = .25;  // rod flat: tool 0.25 m from the rail of leg 1, measured on xy
  for (const double gap : {1e-3, 1e-5, 1e-7}) {
    const Vec3 tool(0, .10 - reach + gap, .3);
    const auto joints = kinematics.inverse(tool);
    ASSERT_TRUE(joints.has_value());
    const Conditioning c = kinematics.conditioning(*joints, tool);
    EXPECT_EQ(c.serial_leg, 0);
    EXPECT_NEAR(c.serial_margin, std::sqrt(2 * gap / reach), 0.01 * std::sqrt(2 * gap / reach));
    EXPECT_LE(c.distance(), c.serial_margin);
  }
  const Vec3 tool(0, .10 - reach, .3);
  const Vec3 joints(.3, .2, .2);
  EXPECT_TRUE(kinematics.jacobian(joints, tool).has_value());
  EXPECT_EQ(kinematics.inverse_jacobian(joints, tool).error(),
            (KinematicsError{Kind::kSerialSingular, 0, 0, 0}));
  EXPECT_TRUE(std::isinf(kinematics.conditioning(joints, tool).condition));
}

// Type 2: with the tool in the plane of the carriages det J_2 = 0 and J does not exist.
TEST(DeltaKinematics, ParallelSingularityIsSeen) {
  const DeltaKinematics kinematics(horizontal());
  const Vec3 flat = Vec3::Constant(-.06);  // carriages on a circle of 0.15 m, rods flat
  const Vec3 tool = Vec3::Zero();
  EXPECT_EQ(kinematics.jacobian(flat, tool).error().kind, Kind::kParallelSingular);
  EXPECT_NEAR(kinematics.conditioning(flat, tool).parallel_margin, 0, 1e-12);
}

TEST(DeltaKinematics, ConditionIsTheRatioOfSingularValues) {
  sweep(asymmetric(), 500, 50, 8, [&](const DeltaKinematics& kinematics, const Pose& pose) {
    const Mat3 j = *kinematics.jacobian(pose.joints, pose.tool);
    const auto values = Eigen::JacobiSVD<Mat3>(j).singularValues();
    EXPECT_NEAR(kinematics.conditioning(pose.joints, pose.tool).condition, values[0] / values[2],
                1e-8 * values[0] / values[2]);
  });
}

TEST(DeltaKinematics, NothingAllocates) {
  const DeltaKinematics kinematics(keops());
  const Vec3 tool(.01, -.005, .09);
  const auto before = telekerf::testing::allocations();
  const auto joints = kinematics.inverse(tool);
  const auto state = kinematics.state(*joints, tool);
  const auto c = kinematics.conditioning(state->joints_m, state->tool_m);
  EXPECT_EQ(telekerf::testing::allocations(), before);
  EXPECT_LT(c.condition, 10);
  static_assert(noexcept(kinematics.forward(tool))&& noexcept(kinematics.inverse(tool))&& noexcept(
      kinematics.state(tool, tool))&& noexcept(kinematics.conditioning(tool, tool)));
}

}  // namespace
}  // namespace telekerf::robot
