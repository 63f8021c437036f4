// SPDX-License-Identifier: Apache-2.0
// The operator's side without bus and clock: node, robot, hand and record, one step at a time. The process
// and the virtual-time lap run this same station.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/messages.h"
#include "common/recording/row_ring.h"
#include "common/recording/run_record.h"
#include "common/robot/supervisor.h"
#include "master/master_node.h"
#include "master/operator/operator_input.h"
#include "master/operator/simulated_operator.h"
#include "master/operator_requests.h"
#include "master/station_settings.h"
#include "master/stream_choice.h"
#include "master/tool_hand.h"

namespace telekerf::master {

/// A contour made ready for the loop: what the constraint and the hand need of it.
struct GuidedContour {
  GuidePath guide;
  SimulatedOperator hand;
  /// The command stream that an operator has asked for meanwhile; null: none, or it has been taken.
  std::unique_ptr<CommandStream> stream;
  StreamChoice choice;             ///< of that stream
  CommandStreamSettings settings;  ///< likewise
};

/// What becomes of an operator's event.
struct EventVerdict {
  std::uint32_t asker = 0;        ///< the epoch of who has said it
  const char* refusal = nullptr;  ///< why nothing comes of it, a literal; null: it is taken up
};

struct StationOutputs : MasterOutputs {
  static constexpr std::size_t kMostVerdicts = 16;
  std::array<EventVerdict, kMostVerdicts> verdicts;
  std::size_t verdict_count = 0;
  void judge(std::uint32_t asker, const char* refusal) noexcept {
    if (verdict_count < verdicts.size()) verdicts[verdict_count++] = {asker, refusal};
  }
  bool say_stop = false;      ///< the operator's device wants an emergency stop
  bool prepare_anew = false;  ///< another scale or stream is asked for: prepare() the contour once more
};

class Station {
 public:
  /// `drive`, `input` (of the button), `hand`: others than those that the settings name. Throws StartupError.
  explicit Station(const StationSettings& settings, robot::Drive drive = {},
                   std::unique_ptr<OperatorInput> input = {}, std::unique_ptr<OperatorInput> hand = {});

  /// At the scale that the settings name or an operator has asked for since, with the command stream that one
  /// has asked for. Allocates: call it outside the loop, from one thread at a time. Throws StartupError if
  /// the robot cannot take the scaled contour, or the stream cannot be made; then what was in force is wanted
  /// again.
  std::unique_ptr<GuidedContour> prepare(const ContourMessage& contour);

  /// One control step: hear, read, decide, write, and let a simulated plant move. `task` may be null.
  StationOutputs step(std::int64_t now_ns, GuidedContour* task, std::span<const Received<StateBlock>> states,
                      std::span<const EventMessage> events, const StopOrder& stop = {}) noexcept;

  /// Guidance or corridor from the next step on.
  void set_constraint(const ConstraintMode& mode) noexcept { constraint_ = mode; }

  /// Why these settings do not go with the slave that answers, whose laser is real: somebody has to be there.
  /// A literal; null: they go.
  const char* obstacle() const noexcept;
  const MasterNode& node() const { return node_; }
  /// Law, estimator and codec of the command stream, by the rows of their tables.
  StreamChoice stream() const noexcept { return streams_.in_force(); }
  const robot::RobotSupervisor& machine() const { return machine_; }
  /// What came in the place of the button's and the hand's datagrams, see OperatorInput::refused().
  std::uint64_t button_refused() const noexcept { return operator_ ? operator_->refused() : 0; }
  std::uint64_t hand_refused() const noexcept { return hand_.refused(); }
  /// After the last step: leaves the robot without current.
  void release() noexcept { machine_.release(); }
  double control_period_s() const { return 1.0 / settings_.node.control_hz; }
  /// The master's part of the record: rows and figures.
  void report(RunRecord& record) const;
  /// The contours of the record: `adopted` have been in force, in order.
  void report_contours(std::span<const ContourMessage> adopted, RunRecord& record) const;
  /// Rows go there, and none are kept here; null: they are kept, as many as fit into record_s.
  void record_to(RowRing* ring) noexcept { ring_ = ring; }
  struct ContourBegin {
    Tick tick = 0;
    std::uint32_t id = 0;
  };
  /// Which contours have been in force, since when.
  std::span<const ContourBegin> in_force() const noexcept { return contours_; }

 private:
  /// The command stream that is asked for, if it is another than the one in force. Throws StartupError.
  void prepare_stream(GuidedContour& task);
  /// What operators say. Wait-free.
  void hear(std::span<const EventMessage> events, bool stopped, StationOutputs& out) noexcept;
  /// The stream that is waited for, if it has come.
  void take_stream(GuidedContour* task, StationOutputs& out) noexcept;

  StationSettings given_;  ///< before validated()
  StationSettings settings_;
  robot::RobotModel model_;
  robot::RobotSupervisor machine_;
  OperatorRequests requests_;
  StreamRequests streams_;
  ToolHand hand_;
  std::unique_ptr<OperatorInput> operator_;  ///< who holds the button; null: the hand
  bool simulated_button_;                    ///< nobody's hand: it lets go when it is told to
  MasterNode node_;
  Recorder<MasterRow> recorder_;
  RowRing* ring_ = nullptr;
  std::vector<ContourBegin> contours_;  ///< in force, since when; room is taken at the start
  bool guided_ = false;
  bool engaged_ = false;
  std::optional<ConstraintMode> constraint_;
};

}  // namespace telekerf::master
