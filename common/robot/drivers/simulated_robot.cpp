// SPDX-License-Identifier: Apache-2.0
#include "common/robot/drivers/simulated_robot.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "common/robot/hall_calibration.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

// End stops: springs of this frequency against the carriage's mass, critically damped while pressed.
constexpr double kStop_rad_per_s = 1000;
constexpr double kStopRoom_m = 5e-3;
constexpr std::size_t kPast = 512;  // steps kept

DeltaGeometry with_room_at_the_stops(DeltaGeometry geometry) {
  geometry.stroke_min_m -= kStopRoom_m;
  geometry.stroke_max_m += kStopRoom_m;
  return geometry;
}

double stop_force(const RobotModel& model, double q, double v) noexcept {
  const double beyond = q < model.geometry.stroke_min_m ? q - model.geometry.stroke_min_m
                                                        : std::max(0.0, q - model.geometry.stroke_max_m);
  if (beyond == 0) return 0;
  const double force = -model.motor.mass_kg * kStop_rad_per_s * (kStop_rad_per_s * beyond + 2 * v);
  return force * beyond < 0 ? force : 0;  // a stop pushes, it never holds back
}

/// What a commissioning sweep over two pitches would have found.
HallCalibration calibration_of(HallSensor& sensor, const Sensor& spec) {
  if (!spec.calibrated) return {};
  constexpr int kSamples = 2000;
  std::vector<HallCounts> sweep;
  sweep.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) sweep.push_back(sensor.sample(2 * spec.pitch_m * i / kSamples));
  return calibrate_hall(sweep, spec.adc_bits).value_or(HallCalibration{});
}

/// At rest, by the mean of many readings: the noise of a single one would stay in the position for good.
void home(HallDecoder& decoder, HallSensor& sensor, double position_m) {
  constexpr int kReadings = 256;
  double mean_m = 0.0, last_m = 0.0;
  for (int i = 0; i < kReadings; ++i) {
    last_m = decoder.update(sensor.sample(position_m));
    mean_m += last_m / kReadings;
  }
  decoder.home(position_m + (last_m - mean_m));
}

}  // namespace

SimulatedRobot::SimulatedRobot(const RobotModel& true_model, std::uint64_t seed, const Vec3& tool_in_base_m)
    : model_(true_model), kinematics_(with_room_at_the_stops(true_model.geometry)) {
  const auto joints = DeltaKinematics(model_.geometry).inverse(tool_in_base_m);
  if (!joints) throw configuration_error(model_.name + " cannot start there: " + describe(joints.error()));
  const auto state = kinematics_.state(*joints, Vec3::Zero());
  if (!state) throw configuration_error(model_.name + " cannot start there: " + describe(state.error()));
  state_ = *state;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 3; ++i) {
    encoder_phase_m_[i] = model_.sensor.resolution_m * static_cast<double>(random() >> 11) * 0x1p-53;
  }
  if (model_.drive_delay_s > 0.0) past_.assign(kPast, {0.0, state_.joints_m});
  if (model_.sensor.kind != Sensor::Kind::kHall) return;
  for (int i = 0; i < 3; ++i) {
    HallSensor sensor(model_.sensor, random());
    HallDecoder decoder(model_.sensor.pitch_m, model_.sensor.adc_bits, calibration_of(sensor, model_.sensor));
    home(decoder, sensor, state_.joints_m[i]);
    hall_.push_back({sensor, decoder});
  }
}

Vec3 SimulatedRobot::read_joints_m() const noexcept {
  if (past_.empty()) return state_.joints_m;
  const double then_s = time_s_ - model_.drive_delay_s;
  const Past* after = &past_[newest_];
  for (std::size_t back = 1; back < past_.size(); ++back) {
    const Past* const before = &past_[(newest_ + past_.size() - back) % past_.size()];
    if (before->time_s <= then_s) {
      const double span_s = after->time_s - before->time_s;
      const double part = span_s > 0.0 ? std::min((then_s - before->time_s) / span_s, 1.0) : 0.0;
      return before->joints_m + part * (after->joints_m - before->joints_m);
    }
    after = before;
  }
  return after->joints_m;
}

JointReading SimulatedRobot::read() noexcept {
  JointReading reading;
  const Vec3 joints_m = read_joints_m();
  const double count_m = model_.sensor.resolution_m;
  for (int i = 0; i < 3; ++i) {
    const double q = joints_m[i];
    if (!hall_.empty()) {
      HallJoint& joint = hall_[static_cast<std::size_t>(i)];
      reading.joints_m[i] = joint.decoder.update(joint.sensor.sample(q, state_.joint_velocity_m_per_s[i]));
      continue;
    }
    // An incremental encoder: whole counts from a place within the first count, known on average.
    reading.joints_m[i] =
        count_m > 0 ? (std::floor((q + encoder_phase_m_[i]) / count_m) + 0.5) * count_m - encoder_phase_m_[i]
                    : q;
  }
  reading.valid = !broken_;
  reading.tick = ++reads_;
  reading.time_ns = static_cast<std::int64_t>(std::llround(time_s_ * 1e9));
  return reading;
}

void SimulatedRobot::write(const Vec3& currents_a) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double force = model_.motor.force_constant_n_per_a * currents_a[i];
    motor_force_n_[i] =
        std::isfinite(force) ? std::clamp(force, -model_.motor.peak_force_n, model_.motor.peak_force_n) : 0.0;
  }
}

Capabilities SimulatedRobot::capabilities() const {
  // Hall: one count of the converter where the sine is steepest (eq. 154 divides the pitch itself).
  const double hall_m = model_.sensor.pitch_m / (2 * std::numbers::pi) * kHallFullScale /
                        std::ldexp(1.0, model_.sensor.adc_bits - 1);
  const double resolution_m = hall_.empty() ? model_.sensor.resolution_m : hall_m;
  return {model_.name, true, resolution_m, model_.motor.peak_force_n, 1 / kInnerStep_s};
}

bool SimulatedRobot::acceleration(const DeltaState& state, Vec3& out) const noexcept {
  Vec3 force = motor_force_n_ + state.jacobian.transpose() * tool_force_n_ - coriolis_force(model_, state) -
               gravity_force(model_, kinematics_, state) -
               friction_force(model_.friction, state.joint_velocity_m_per_s);
  for (int i = 0; i < 3; ++i)
    force[i] += stop_force(model_, state.joints_m[i], state.joint_velocity_m_per_s[i]);
  out = joint_inertia(model_, state).inverse() * force;
  return out.allFinite();
}

void SimulatedRobot::inner_step(double h) noexcept {
  const Vec3 q = state_.joints_m;
  const Vec3 v = state_.joint_velocity_m_per_s;
  const auto slope = [&](const Vec3& at_q, const Vec3& at_v, Vec3& a) {
    const auto state = kinematics_.state(at_q, at_v);
    return state.has_value() && acceleration(*state, a);
  };
  Vec3 a1, a2, a3, a4;
  const bool moved = acceleration(state_, a1) && slope(q + 0.5 * h * v, v + 0.5 * h * a1, a2) &&
                     slope(q + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2, a3) &&
                     slope(q + h * v + 0.5 * h * h * a2, v + h * a3, a4);
  if (moved) {
    const auto next =
        kinematics_.state(q + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4));
    if (next) {
      state_ = *next;
      return;
    }
  }
  broken_ = true;
  state_.joint_velocity_m_per_s.setZero();
  state_.tool_velocity_m_per_s.setZero();
}

void SimulatedRobot::advance(double dt_s) noexcept {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kInnerStep_s - 1e-6)));
  for (int i = 0; i < steps && !broken_; ++i) inner_step(dt_s / steps);
  time_s_ += dt_s;
  if (past_.empty()) return;
  newest_ = (newest_ + 1) % past_.size();
  past_[newest_] = {time_s_, state_.joints_m};
}

Drive open_simulated_drive(std::string_view, const DriveNeeds& needs) {
  const auto& [mismatch, seed, sensor] = needs.simulation;
  RobotModel truth = mismatched(needs.nominal, mismatch, seed);
  truth.sensor.kind = sensor.value_or(truth.sensor.kind);
  auto robot = std::make_unique<SimulatedRobot>(truth, seed, needs.nominal.in_base(Vec3::Zero()));
  SimulatedRobot* const plant = robot.get();
  return {std::move(robot), plant};
}

}  // namespace telekerf::robot
