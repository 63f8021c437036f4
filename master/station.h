// SPDX-License-Identifier: Apache-2.0
// The operator's side without bus and clock: node, robot, hand and record, one step at a time. The process
// and the virtual-time lap run this same station.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/protocol/messages.h"
#include "common/recording/run_record.h"
#include "common/robot/supervisor.h"
#include "master/master_node.h"
#include "master/operator/operator_input.h"
#include "master/operator/simulated_operator.h"
#include "master/operator_requests.h"
#include "master/station_settings.h"

namespace telekerf::master {

/// A contour made ready for the loop: what the constraint and the hand need of it.
struct GuidedContour {
  GuidePath guide;
  SimulatedOperator hand;
};

struct StationOutputs : MasterOutputs {
  /// A literal: why nothing comes of what the operator said, or why the slave is let go.
  const char* refusal = nullptr;
  bool prepare_anew = false;  ///< another scale is asked for: prepare() the contour once more
};

class Station {
 public:
  /// `drive`, `input`: others than those that the settings name. Throws StartupError.
  explicit Station(const StationSettings& settings, robot::Drive drive = {},
                   std::unique_ptr<OperatorInput> input = {});

  /// At the scale that the settings name or an operator has asked for since. Allocates: call it outside the
  /// loop, from one thread at a time. Throws StartupError if the robot cannot take the scaled contour; then
  /// the scale that was in force is wanted again.
  std::unique_ptr<GuidedContour> prepare(const ContourMessage& contour);

  /// One control step: hear, read, decide, write, and let a simulated plant move. `task` may be null.
  StationOutputs step(std::int64_t now_ns, GuidedContour* task, std::span<const Received<StateBlock>> states,
                      std::span<const EventMessage> events, const StopOrder& stop = {}) noexcept;

  /// Guidance or corridor from the next step on.
  void set_constraint(const ConstraintMode& mode) noexcept { constraint_ = mode; }

  const MasterNode& node() const { return node_; }
  const robot::RobotSupervisor& machine() const { return machine_; }
  /// After the last step: leaves the robot without current.
  void release() noexcept { machine_.release(); }
  double control_period_s() const { return 1.0 / settings_.node.control_hz; }
  /// The master's part of the record: rows and figures.
  void report(RunRecord& record) const;

 private:
  /// Simulated on a simulated robot; a real hand is felt by the robot alone.
  HandSample hand(GuidedContour& task) noexcept;

  StationSettings settings_;
  robot::RobotModel model_;
  robot::RobotSupervisor machine_;
  OperatorRequests requests_;
  std::unique_ptr<OperatorInput> operator_;  ///< null: the simulated operator alone
  bool simulated_button_;                    ///< nobody's hand: it lets go when it is told to
  MasterNode node_;
  Recorder<MasterRow> recorder_;
  bool guided_ = false;
  bool engaged_ = false;
  std::optional<ConstraintMode> constraint_;
};

}  // namespace telekerf::master
