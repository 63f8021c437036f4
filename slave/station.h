// SPDX-License-Identifier: Apache-2.0
// The workpiece's side without bus and clock: node, robot, laser and record, one step at a time. The process
// and the virtual-time lap run this same station.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "common/codec/codec_table.h"
#include "common/protocol/messages.h"
#include "common/recording/row_ring.h"
#include "common/recording/run_record.h"
#include "common/robot/supervisor.h"
#include "common/runtime/settings.h"
#include "slave/laser/laser_output.h"
#include "slave/slave_node.h"

namespace telekerf::slave {

struct StationSettings {
  SlaveSettings node;
  std::string robot = "slave-keops";
  robot::RobotSupervisorSettings machine;
  laser::LaserOutputSettings beam;
  double laser_speed_mm_s = 10.0;                   ///< of the tool that gets laser_w
  codec::CodecChoice codec = codec::kDefaultCodec;  ///< of both parts of the state stream
  double mismatch = 0.1;  ///< how far the simulated robot is off its file, as a share
  std::uint64_t seed = 1;
  std::uint32_t epoch = 1;
  double record_s = 120.0;
  /// Every setting of the station.
  void add_parameters(Settings& settings);
  /// Those of its control, of the state stream and of the beam's power.
  void add_node_parameters(Settings& settings);
  /// The settings, or a StartupError that names what does not fit.
  StationSettings validated() const;
};

class Station {
 public:
  /// `drive`, `laser`: others than those that the settings name. Throws StartupError.
  explicit Station(const StationSettings& settings, robot::Drive drive = {},
                   std::unique_ptr<laser::Laser> laser = {});

  /// Allocates: call it outside the loop. Throws StartupError if the contour leaves the workspace.
  std::unique_ptr<Corridor> prepare(const ContourMessage& contour) const;

  SlaveOutputs step(std::int64_t now_ns, const Corridor* corridor,
                    std::span<const Received<CommandBlock>> commands, const StopOrder& stop = {},
                    double look_age_s = laser::kAbsent) noexcept;

  /// See SlaveNode::change().
  void change(const codec::StreamSettings& feedback, const codec::StreamSettings& force) {
    node_.change(feedback, force);
  }
  /// See SlaveNode::new_workpiece().
  void new_workpiece() noexcept { node_.new_workpiece(); }
  const SlaveNode& node() const { return node_; }
  const robot::RobotSupervisor& machine() const { return machine_; }
  const laser::LaserOutput& beam() const noexcept { return beam_; }
  /// After the last step: beam off, then the robot without current.
  void release() noexcept {
    beam_.off();
    machine_.release();
  }
  double control_period_s() const { return 1.0 / settings_.node.control_hz; }
  Tick tick() const noexcept { return tick_; }
  void report(RunRecord& record) const;
  /// Rows go there, and none are kept here; null: they are kept, as many as fit into record_s.
  void record_to(RowRing* ring) noexcept { ring_ = ring; }

 private:
  StationSettings settings_;
  robot::RobotModel model_;
  robot::RobotSupervisor machine_;
  laser::LaserOutput beam_;
  SlaveNode node_;
  laser::BeamMonitor monitor_;
  Recorder<SlaveRow> recorder_;
  RowRing* ring_ = nullptr;
  Tick tick_ = 0;
  struct {
    double sum_s = 0.0;
    double max_s = 0.0;
    std::uint64_t count = 0;
    void add(double age_s) noexcept {
      sum_s += age_s;
      max_s = max_s > age_s ? max_s : age_s;
      ++count;
    }
  } age_;  ///< of the commands applied
};

}  // namespace telekerf::slave
