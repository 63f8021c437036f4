// SPDX-License-Identifier: Apache-2.0
// Whose hand is on the master's tool: a device's, or the simulated operator's.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "common/robot/supervisor.h"
#include "master/operator/arm.h"
#include "master/operator/operator_input.h"
#include "master/operator/simulated_operator.h"

namespace telekerf::master {

class ToolHand {
 public:
  /// `device` null: the simulated operator.
  ToolHand(const ArmSettings& arm, std::unique_ptr<OperatorInput> device)
      : arm_(arm), device_(std::move(device)) {}

  bool simulated() const noexcept { return device_ == nullptr; }
  /// Once every control step. A force is known on a simulated robot alone: a real hand is felt by the robot.
  /// `now_s`: by the steps so far. `simulated` null: no contour yet. `guided`: the constraint holds the tool.
  HandSample sample(std::int64_t now_ns, double now_s, const robot::RobotSupervisor& machine,
                    SimulatedOperator* simulated, double beta, bool guided) noexcept;
  /// At its end: what became of it.
  void answer(const OperatorAnswer& answer) noexcept {
    if (device_) device_->answer(answer);
  }
  /// See OperatorInput::refused().
  std::uint64_t refused() const noexcept { return device_ ? device_->refused() : 0; }
  /// A device says, and its lease grants, that somebody holds the tool.
  bool held() const noexcept { return held_; }

 private:
  ArmSettings arm_;
  std::unique_ptr<OperatorInput> device_;
  bool held_ = false;
};

}  // namespace telekerf::master
