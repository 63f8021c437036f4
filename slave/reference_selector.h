// SPDX-License-Identifier: Apache-2.0
// What the slave's tool is to follow: the command stream, while it leads within the limits, or a pose that is
// held. One reference without a jump, whatever it comes from.
#pragma once

#include <cstdint>
#include <span>

#include "common/control/bumpless_transfer.h"
#include "common/protocol/messages.h"
#include "common/robot/robot_model.h"
#include "common/runtime/enum_table.h"
#include "common/streaming/acknowledgement.h"
#include "common/streaming/command_receiver.h"
#include "slave/arming.h"

namespace telekerf::slave {

using control::KinematicState;

/// What the slave makes of a stream of accelerations that comes without anchors (law remote-acceleration).
enum class BareAccelerations : std::uint8_t { kObeyed, kIntegrated };
inline constexpr EnumRow<BareAccelerations> kBareAccelerationRows[] = {
    {"obeyed", BareAccelerations::kObeyed, "each is the tool's, as in the thesis; nothing else holds it"},
    {"integrated", BareAccelerations::kIntegrated,
     "a reference is integrated from where the tool stood, and the slave's own loop holds the tool to it"}};
inline constexpr EnumTable<BareAccelerations> kBareAccelerations(kBareAccelerationRows);

/// Of one control step.
struct Selected {
  KinematicState reference;
  Vec3 source_m = Vec3::Zero();  ///< what the reference comes to when nothing is left of a transfer
  bool following = false;  ///< a sample of the stream is followed; false: the way on from one, or a held pose
  /// The stream's accelerations are all there is: nothing draws the tool to the reference, which is the tool.
  bool bare = false;
  Vec3 acceleration_m_per_s2 = Vec3::Zero();  ///< of the source, without what is left of a transfer
  bool button = false;
  double age_s = -1.0;         ///< of the command that is applied, by the slave's clock; negative: none
  double due_age_s = -1.0;     ///< of the command whose turn it is, followed or not; negative: none
  double applied_tick = -1.0;  ///< master tick that the reference is of; negative: none
  streaming::Acknowledgement acknowledgement;
};

class ReferenceSelector {
 public:
  /// `model`: workspace and limits of the slave's robot.
  ReferenceSelector(const robot::RobotModel& model, const control::BumplessTransferSettings& transfer,
                    double dt_s, BareAccelerations bare = BareAccelerations::kObeyed,
                    const FreshnessSettings& freshness = {});

  /// The tool rests here when nobody has led it yet.
  void rest_at(const Vec3& position_m) noexcept;
  /// Every control step, once.
  Selected step(const streaming::Played& played, const Circumstances& now) noexcept;

  SlaveMode mode() const noexcept { return mode_; }
  HoldReason reason() const noexcept { return reason_; }
  const Arming& arming() const noexcept { return arming_; }
  const KinematicState& reference() const noexcept { return reference_; }
  /// What is left of a change of source.
  double offset_m() const noexcept { return transfer_.offset_m(); }
  /// Steps at which a sample was to be followed that was not there.
  std::uint64_t missed_ticks() const noexcept { return missed_ticks_; }

 private:
  bool follows(const streaming::Played& played, const Circumstances& now) noexcept;
  /// Why a sample of the stream that leads is not followed.
  HoldReason refusal(const streaming::Played& played) noexcept;
  KinematicState brake() noexcept;
  KinematicState follow(const streaming::Played& played) noexcept;
  KinematicState hold(std::int64_t unled_steps, bool waits) noexcept;
  void transfer_to(const KinematicState& source) noexcept;
  /// Slow enough, and to be stopped before the workspace ends.
  bool within_limits(const KinematicState& state) const noexcept;
  /// No faster and no more abrupt than the robot can be.
  bool is_motion(const KinematicState& state) const noexcept;
  void clamp_to_workspace(KinematicState& state) const noexcept;

  double radius_m_;
  double half_height_m_;
  double max_m_per_s_;
  double max_m_per_s2_;
  double dt_s_;
  BareAccelerations bare_;
  double follow_age_s_;
  SlaveMode mode_ = SlaveMode::kWaiting;
  HoldReason reason_ = HoldReason::kNoCommands;
  Arming arming_;
  control::BumplessTransfer transfer_;
  streaming::AcknowledgementLog log_;
  KinematicState reference_;
  KinematicState hold_;                  ///< source while not following
  Vec3 led_m_ = Vec3::Zero();            ///< reference when a sample was followed last
  Vec3 source_m_ = Vec3::Zero();         ///< where a sample with a place led last
  bool stopping_ = false;                ///< hold_ is braked since an emergency stop
  KinematicState integral_;              ///< of bare accelerations
  std::uint32_t source_generation_ = 0;  ///< 0: holding
  std::uint32_t source_block_ = 0;
  Law source_law_ = Law::kLocal;
  bool transferred_ = false;  ///< the source changed at this very step
  bool tripped_ = false;      ///< bare accelerations led out of bounds: held until disengaged
  std::uint64_t missed_ticks_ = 0;
};

}  // namespace telekerf::slave
