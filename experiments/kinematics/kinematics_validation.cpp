// SPDX-License-Identifier: Apache-2.0
#include "experiments/kinematics/kinematics_validation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"
#include "experiments/kinematics/kinematics_mujoco.h"

namespace telekerf::experiments {
namespace {

using robot::DeltaKinematics;
using robot::Mat3;
using robot::RobotModel;
using robot::SimulatedRobot;

constexpr double kEngineStep_s = 5e-5;
constexpr double kSample_s = 1e-3;
constexpr int kStepsPerSample = 20;

template <typename T>
T value(const tl::expected<T, robot::KinematicsError>& result) {
  if (!result) throw input_error("the motion left what the robot can do: " + robot::describe(result.error()));
  return *result;
}

/// The thesis' Cartesian robot: a PID force on the tool.
class CartesianDrive {
 public:
  CartesianDrive(double mass_kg, const Vec3& holding_n) : mass_kg_(mass_kg), integral_n_(holding_n) {}
  Vec3 force(const Vec3& error_m, const Vec3& velocity) {
    constexpr double w = 60;  // rad/s
    integral_n_ += mass_kg_ * w * w * w * 0.1 * kSample_s * error_m;
    return mass_kg_ * (w * w * error_m - 2 * w * velocity) + integral_n_;
  }

 private:
  double mass_kg_;
  Vec3 integral_n_;
};

/// Same motor law on both machines for one second; each is fed its own motion. Stops when a carriage leaves
/// the rail.
template <typename Law>
DynamicsValidation race(const RobotModel& robot, Law law) {
  const DeltaKinematics kinematics(robot.geometry);
  const Vec3 start = robot.workspace.centre_m;
  MujocoDelta engine(robot, value(kinematics.inverse(start)), start, kEngineStep_s);
  SimulatedRobot ours(robot, 1, start);
  DynamicsValidation result;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * kSample_s;
    engine.set_motor_force(law(t, engine.joints_m(), engine.joint_velocity_m_per_s()));
    const auto& state = ours.true_state();
    ours.write(law(t, state.joints_m, state.joint_velocity_m_per_s) / robot.motor.force_constant_n_per_a);
    for (int k = 0; k < kStepsPerSample; ++k) engine.step();
    ours.advance(kSample_s);
    (void)value(kinematics.forward(ours.true_state().joints_m));
    result.worst_difference_m =
        std::max(result.worst_difference_m, (engine.tool_m() - ours.true_tool_in_base_m()).norm());
    result.travelled_m = std::max(result.travelled_m, (engine.tool_m() - start).norm());
  }
  return result;
}

RobotModel without_friction(RobotModel robot) {
  robot.friction = {};
  return robot;
}

}  // namespace

KinematicsValidation validate_kinematics(const RobotModel& robot, double step_m) {
  const DeltaKinematics kinematics(robot.geometry);
  const Vec3 centre = robot.workspace.centre_m;
  const Vec3 start_joints = value(kinematics.inverse(centre));
  MujocoDelta engine(robot, start_joints, centre, kEngineStep_s);
  const auto state = value(kinematics.state(start_joints, Vec3::Zero()));
  // What holds the whole machine by its tool against gravity.
  const Vec3 holding = state.inverse_jacobian.transpose() * robot::gravity_force(robot, kinematics, state);
  CartesianDrive drive(robot.tool_mass_kg + 2 * robot.motor.mass_kg, holding);

  KinematicsValidation result;
  constexpr double kHold_s = 0.5;
  const double end_s = 6 * kHold_s;
  double fastest = 0, worst_velocity = 0;
  for (int i = 0; i * kSample_s < end_s; ++i) {
    KinematicsSample sample;
    sample.time_s = i * kSample_s;
    sample.reference_m = centre;
    const int stage = static_cast<int>(sample.time_s / kHold_s);
    if (stage % 2 == 0) sample.reference_m[stage / 2] += step_m;

    sample.tool_m = engine.tool_m();
    sample.joints_m = engine.joints_m();
    sample.velocity_m_per_s = engine.tool_velocity_m_per_s();
    const Vec3 joint_velocity = engine.joint_velocity_m_per_s();
    const Vec3 rods = engine.rod_error_m();

    // A rod that is longer by delta: (tool - S_i) . dx = l_i delta (tool moved), f_di dd = l_i delta
    // (carriage moved).
    const Mat3 jacobian = value(kinematics.jacobian(sample.joints_m, sample.tool_m));
    Vec3 f_d;
    for (int leg = 0; leg < 3; ++leg) {
      const double theta = robot.geometry.rail_angle_rad[static_cast<std::size_t>(leg)];
      const Vec3 tool_joint =
          sample.tool_m + robot.geometry.tool_radius_m * Vec3(std::cos(theta), std::sin(theta), 0);
      f_d[leg] = (kinematics.carriage(leg, sample.joints_m[leg]) - tool_joint).dot(kinematics.rail(leg));
    }
    const Vec3 lengths = Eigen::Map<const Vec3>(robot.geometry.rod_length_m.data());
    const Vec3 joint_shift = lengths.cwiseProduct(rods).cwiseQuotient(f_d);

    sample.tool_calculated_m = value(kinematics.forward(sample.joints_m)) - jacobian * joint_shift;
    sample.joints_calculated_m = value(kinematics.inverse(sample.tool_m)) + joint_shift;
    sample.velocity_calculated_m_per_s = jacobian * joint_velocity;

    result.worst_forward_m =
        std::max(result.worst_forward_m, (sample.tool_calculated_m - sample.tool_m).norm());
    result.worst_inverse_m = std::max(result.worst_inverse_m,
                                      (sample.joints_calculated_m - sample.joints_m).cwiseAbs().maxCoeff());
    fastest = std::max(fastest, sample.velocity_m_per_s.norm());
    worst_velocity =
        std::max(worst_velocity, (sample.velocity_calculated_m_per_s - sample.velocity_m_per_s).norm());
    result.worst_violation_m = std::max(result.worst_violation_m, rods.cwiseAbs().maxCoeff());
    result.worst_tilt_rad = std::max(result.worst_tilt_rad, engine.tilt_rad());
    result.samples.push_back(sample);

    engine.set_tool_force(drive.force(sample.reference_m - sample.tool_m, sample.velocity_m_per_s));
    for (int k = 0; k < kStepsPerSample; ++k) engine.step();
  }
  result.worst_velocity = worst_velocity / fastest;
  return result;
}

DynamicsValidation validate_free_fall(const RobotModel& nominal) {
  RobotModel robot = without_friction(nominal);
  const DeltaKinematics kinematics(robot.geometry);
  const auto start =
      value(kinematics.state(value(kinematics.inverse(robot.workspace.centre_m)), Vec3::Zero()));
  // Under full gravity a carriage is at its end stop after some 50 ms: weakened, the same fall takes the
  // second.
  const Vec3 acceleration = start.jacobian * robot::joint_inertia(robot, start).inverse() *
                            robot::gravity_force(robot, kinematics, start);
  const double fall_m = 0.35 * std::min(robot.workspace.radius_m, robot.workspace.height_m);
  robot.gravity_m_per_s2 *= 2 * fall_m / acceleration.norm();
  return race(robot, [](double, const Vec3&, const Vec3&) -> Vec3 { return Vec3::Zero(); });
}

DynamicsValidation validate_forced_motion(const RobotModel& nominal) {
  const RobotModel robot = without_friction(nominal);
  const DeltaKinematics kinematics(robot.geometry);
  const auto start =
      value(kinematics.state(value(kinematics.inverse(robot.workspace.centre_m)), Vec3::Zero()));
  const Vec3 holding = robot::gravity_force(robot, kinematics, start);
  const double mass = robot.motor.mass_kg;
  constexpr double w = 20;  // rad/s, of the springs
  const double amplitude_m = 0.1 * std::min(nominal.workspace.radius_m, nominal.workspace.height_m);
  return race(robot, [=](double t, const Vec3& q, const Vec3& qd) -> Vec3 {
    const Vec3 drive(std::sin(9 * t), std::sin(11 * t + 1), std::sin(13 * t + 2));
    return holding + mass * (w * w * (start.joints_m - q + amplitude_m * drive) - 0.2 * w * qd);
  });
}

}  // namespace telekerf::experiments
