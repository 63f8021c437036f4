// SPDX-License-Identifier: Apache-2.0
// What a user sets of the operator's side.
#pragma once

#include <cstdint>
#include <string>

#include "common/codec/codec_table.h"
#include "common/robot/supervisor.h"
#include "common/runtime/settings.h"
#include "master/master_node.h"
#include "master/operator/arm.h"
#include "master/operator/simulated_operator.h"
#include "master/operator/space_mouse.h"

namespace telekerf::master {

struct StationSettings {
  MasterSettings node;
  std::string robot = "master-horizontal";
  robot::RobotSupervisorSettings machine;
  std::string hand_device = "simulated";  ///< who moves a simulated master, see operator_input.h
  std::string button = "hand";            ///< who holds the laser button, see there
  double beta = 0.5;
  bool engage = false;    ///< the slave shall follow without being told to
  double mismatch = 0.1;  ///< how far the simulated robot is off its file, as a share
  SimulatedOperatorSettings hand;
  ArmSettings arm;                ///< between a pointer and the tool
  SpaceMouseSettings cap;         ///< of hand = spacemouse
  double hand_speed_mm_s = 20.0;  ///< what a user sets of it
  double tracking_rad_s = 0.0;    ///< of the law; 0: chosen from the stream's rate
  double beam_age_s = 0.35;       ///< the slave's, see MasterSettings::stale_s
  double corridor_mm = 0.0;       ///< half width in which the hand is free; 0: guidance
  double felt_depth_mm = 0.0;     ///< of the cut, FeltCutSettings::depth_m
  double felt_depth_speed_mm2_per_s = 3.0;
  codec::CodecChoice codec = codec::kDefaultCodec;  ///< of the command stream
  std::uint64_t seed = 1;
  std::uint32_t epoch = 1;
  double record_s = 120.0;  ///< length of the record kept
  /// Every setting of the station.
  void add_parameters(Settings& settings);
  /// Those of what travels to the slave: who computes its acceleration, how it is predicted and coded.
  void add_stream_parameters(Settings& settings);
  /// Those of the constraint, the robot's control and the simulated hand.
  void add_guidance_parameters(Settings& settings);
  /// The settings, or a StartupError that names what does not fit.
  StationSettings validated() const;
};

}  // namespace telekerf::master
