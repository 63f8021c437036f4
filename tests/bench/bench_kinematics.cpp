// SPDX-License-Identifier: Apache-2.0
// Closed-form kinematics against an iterative peer and a rigid-body engine, in one run.
//
// Method: 4096 random poses of the workspace, visited in order, so that nothing stays predicted; warm-up,
// then rounds over all poses in which the candidates take turns; per round the time of one pose; median, p99
// and max of rounds.
// - Closed form: FK, IK, Jacobian and its rate with all their checks; once as a control step calls them
//   (inverse and state), once as four calls that share nothing. The slower of the two counts.
// - Newton: FK alone, from the same equations, with Eigen's closed 3x3 inverse, started at the workspace's
//   centre, stopped at a step below 1e-12 m.
// - MuJoCo: mj_forward of the same machine (closed chain by equality constraints).
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/robot/robot_model.h"
#ifdef TELEKERF_WITH_MUJOCO
#include "experiments/kinematics/kinematics_mujoco.h"
#endif

namespace {

using telekerf::Vec3;
using namespace telekerf::robot;

constexpr int kPoses = 4096;
constexpr int kRounds = 300;
constexpr int kWarmUp = 20;

struct Pose {
  Vec3 joints, tool, joint_velocity, tool_velocity;
};

/// What the optimiser must not remove.
double sink = 0;

class Newton {
 public:
  explicit Newton(const RobotModel& robot) : start_(robot.workspace.centre_m) {
    const DeltaGeometry& g = robot.geometry;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 outward(std::cos(g.rail_angle_rad[i]), std::sin(g.rail_angle_rad[i]), 0);
      origin_[i] = (g.base_radius_m - g.tool_radius_m) * outward;
      rail_[i] = -std::cos(g.attack_angle_rad[i]) * outward + std::sin(g.attack_angle_rad[i]) * Vec3::UnitZ();
      squared_length_[i] = g.rod_length_m[i] * g.rod_length_m[i];
    }
  }

  Vec3 forward(const Vec3& joints, int& iterations) const {
    std::array<Vec3, 3> centre;
    for (std::size_t i = 0; i < 3; ++i) centre[i] = origin_[i] + joints[static_cast<int>(i)] * rail_[i];
    Vec3 x = start_;
    for (int k = 0; k < 20; ++k) {
      Mat3 slope;
      Vec3 residual;
      for (int i = 0; i < 3; ++i) {
        const Vec3 rod = x - centre[static_cast<std::size_t>(i)];
        slope.row(i) = 2 * rod.transpose();
        residual[i] = rod.squaredNorm() - squared_length_[static_cast<std::size_t>(i)];
      }
      const Vec3 step = slope.inverse() * residual;
      x -= step;
      ++iterations;
      if (step.squaredNorm() < 1e-24) break;
    }
    return x;
  }

 private:
  Vec3 start_;
  std::array<Vec3, 3> origin_, rail_;
  std::array<double, 3> squared_length_{};
};

struct Candidate {
  std::string name;
  std::vector<double> ns;  // of one pose, one a round

  double at(double share) const {
    std::vector<double> sorted = ns;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1,
                           static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
  }
};

template <typename Work>
double time_of(const std::vector<Pose>& poses, std::size_t count, Work work) {
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < count; ++i) work(poses[i]);
  const auto end = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::nano>(end - start).count() / static_cast<double>(count);
}

std::vector<Pose> random_poses(const RobotModel& robot, const DeltaKinematics& kinematics) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Pose> poses;
  while (poses.size() < kPoses) {
    const double angle = std::numbers::pi * unit(random),
                 radius = robot.workspace.radius_m * std::sqrt(std::abs(unit(random)));
    Pose pose;
    pose.tool = robot.in_base(
        {radius * std::cos(angle), radius * std::sin(angle), 0.5 * robot.workspace.height_m * unit(random)});
    pose.joints = *kinematics.inverse(pose.tool);
    pose.joint_velocity = 0.2 * Vec3(unit(random), unit(random), unit(random));
    pose.tool_velocity = *kinematics.jacobian(pose.joints, pose.tool) * pose.joint_velocity;
    poses.push_back(pose);
  }
  return poses;
}

bool compare(const std::string& name) {
  const RobotModel robot = load_robot(name);
  const DeltaKinematics kinematics(robot.geometry);
  const Newton newton(robot);
  const std::vector<Pose> poses = random_poses(robot, kinematics);

  double worst = 0;
  for (const auto& pose : poses) {
    int unused = 0;
    worst = std::max(worst, (newton.forward(pose.joints, unused) - *kinematics.forward(pose.joints)).norm());
  }

  Candidate ours{"closed form: IK, state (FK, J, dJ/dt)", {}},
      calls{"closed form: FK, IK, J, dJ/dt alone", {}}, peer{"Newton: FK", {}},
      engine{"MuJoCo: forward pass", {}};
  int iterations = 0;
#ifdef TELEKERF_WITH_MUJOCO
  telekerf::experiments::MujocoDelta mujoco(robot, poses[0].joints, poses[0].tool, 1e-4);
  constexpr std::size_t kEnginePoses = 64;
#endif
  for (int round = -kWarmUp; round < kRounds; ++round) {
    const double a = time_of(poses, poses.size(), [&](const Pose& p) {
      const Vec3 joints = *kinematics.inverse(p.tool);
      const DeltaState state = *kinematics.state(p.joints, p.joint_velocity);
      sink += state.tool_m.x() + joints.y() + state.jacobian.trace() + state.jacobian_rate.trace();
    });
    const double alone = time_of(poses, poses.size(), [&](const Pose& p) {
      const Vec3 tool = *kinematics.forward(p.joints);
      const Vec3 joints = *kinematics.inverse(p.tool);
      const Mat3 jacobian = *kinematics.jacobian(p.joints, p.tool);
      const Mat3 rate = *kinematics.jacobian_rate(p.joints, p.tool, p.joint_velocity, p.tool_velocity);
      sink += tool.x() + joints.y() + jacobian.trace() + rate.trace();
    });
    iterations = 0;
    const double b = time_of(poses, poses.size(),
                             [&](const Pose& p) { sink += newton.forward(p.joints, iterations).z(); });
    if (round >= 0) ours.ns.push_back(a), calls.ns.push_back(alone), peer.ns.push_back(b);
#ifdef TELEKERF_WITH_MUJOCO
    const double c = time_of(poses, kEnginePoses, [&](const Pose& p) {
      mujoco.place(p.joints, p.tool);
      mujoco.forward();
      sink += mujoco.tool_m().x();
    });
    if (round >= 0) engine.ns.push_back(c);
#endif
  }

  fmt::print("{}: Newton takes {:.1f} iterations and ends within {:.1e} m of the closed form\n", name,
             static_cast<double>(iterations) / kPoses, worst);
  for (const Candidate* c : {&ours, &calls, &peer, &engine}) {
    if (c->ns.empty()) continue;
    fmt::print("  {:<34} {:>9.0f} ns median {:>9.0f} p99 {:>9.0f} max\n", c->name, c->at(0.5), c->at(0.99),
               c->at(1));
  }
  const double slower = std::max(ours.at(0.5), calls.at(0.5));
  const double to_newton = peer.at(0.5) / slower;
  fmt::print("  Newton's one FK / all four of ours: {:.2f} (bar: at least 1)\n", to_newton);
  bool good = to_newton >= 1;
  if (!engine.ns.empty()) {
    const double to_engine = engine.at(0.5) / slower;
    fmt::print("  MuJoCo's forward pass / all four of ours: {:.0f} (bar: at least 20)\n", to_engine);
    good = good && to_engine >= 20;
  }
  return good;
}

}  // namespace

int main() {
  bool good = true;
  for (const auto* name : {"master-horizontal", "slave-keops", "vertical", "asymmetric"})
    good = compare(name) && good;
  fmt::print("{} (checksum {:.3g})\n", good ? "good" : "BAR MISSED", sink);
  return good ? 0 : 1;
}
