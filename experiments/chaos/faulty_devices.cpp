// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/faulty_devices.h"

#include <algorithm>
#include <utility>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

class FaultyRobot final : public robot::Robot {
 public:
  FaultyRobot(std::unique_ptr<robot::SimulatedRobot> robot, SensorFault& fault)
      : robot_(std::move(robot)), fault_(fault) {}

  robot::JointReading read() noexcept override {
    robot::JointReading reading = robot_->read();
    if (fault_.dropout) {
      reading.valid = false;
      return reading;
    }
    reading.joints_m += fault_.slip_m;
    if (fault_.stuck) reading.joints_m[0] = fault_.held_m;
    fault_.held_m = reading.joints_m[0];
    return reading;
  }
  void write(const Vec3& currents_a) noexcept override { robot_->write(currents_a); }
  robot::Capabilities capabilities() const override { return robot_->capabilities(); }

 private:
  std::unique_ptr<robot::SimulatedRobot> robot_;
  SensorFault& fault_;
};

class FaultyLaser final : public laser::Laser {
 public:
  explicit FaultyLaser(LaserState& state) : state_(state) {}
  bool emit(const laser::Emission& told) noexcept override {
    const double power_w = told.power_w;
    state_.told_w = power_w;
    state_.unheard = state_.deaf ? state_.unheard + 1 : 0;
    if (!state_.deaf) state_.emitted_w = power_w;
    if (state_.unheard >= kSilentLaserSteps) state_.emitted_w = 0.0;
    disabled_ = told.enable > enable_ ? 0 : disabled_ + 1;
    enable_ = std::max(enable_, told.enable);
    if (state_.stuck) state_.emitted_w = disabled_ < kSilentLaserSteps ? kStuck_w : 0.0;
    return !state_.deaf;
  }
  bool stray() noexcept override { return !state_.deaf && state_.emitted_w > 1.5 * state_.told_w; }

 private:
  static constexpr double kStuck_w = 10.0;
  LaserState& state_;
  std::uint64_t enable_ = 0;
  int disabled_ = kSilentLaserSteps;  ///< steps without a larger enable, which cuts the supply
};

class ScriptedButton final : public master::OperatorInput {
 public:
  explicit ScriptedButton(const bool& pressed) : pressed_(pressed) {}
  master::OperatorSample sample(std::int64_t /*now_ns*/) noexcept override { return {.trigger = pressed_}; }

 private:
  const bool& pressed_;
};

}  // namespace

robot::Drive faulty_drive(const robot::RobotModel& truth, std::uint64_t seed, const Vec3& tool_in_base_m,
                          SensorFault& fault) {
  std::unique_ptr<robot::SimulatedRobot> plant;
  try {
    plant = std::make_unique<robot::SimulatedRobot>(truth, seed, tool_in_base_m);
  } catch (const StartupError&) {
    plant = std::make_unique<robot::SimulatedRobot>(truth, seed, truth.in_base(Vec3::Zero()));
  }
  robot::SimulatedRobot* const seen = plant.get();
  return {std::make_unique<FaultyRobot>(std::move(plant), fault), seen};
}

std::unique_ptr<laser::Laser> faulty_laser(LaserState& state) { return std::make_unique<FaultyLaser>(state); }

std::unique_ptr<master::OperatorInput> scripted_button(const bool& pressed) {
  return std::make_unique<ScriptedButton>(pressed);
}

}  // namespace telekerf::experiments
