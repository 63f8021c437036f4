// SPDX-License-Identifier: Apache-2.0
// From the master's motion to command blocks (eq. 79-96): an engagement says whether the slave is led, a law
// what it is commanded, the network observer on which idea of its state; the packetizer sends it.
#pragma once

#include <cstdint>
#include <optional>

#include "common/protocol/messages.h"
#include "common/streaming/packetizer.h"
#include "common/streaming/redundancy_control.h"
#include "common/streaming/state_receiver.h"
#include "master/engagement.h"
#include "master/law.h"
#include "master/observer/network_observer.h"

namespace telekerf::master {

struct CommandStreamSettings : LawSettings {
  ObserverSettings observer;
  codec::StreamSettings codec;                 ///< its redundancy: on a link that leaves no gaps
  int max_redundancy = codec::kMaxRedundancy;  ///< on one that does
  int ticks_per_sample = 1;
  Vec3 wrong_position_m = Vec3::Zero();  ///< by which the first idea of the slave is wrong, for trials
  Vec3 wrong_velocity_m_per_s = Vec3::Zero();
  /// The button is passed on only where the slave is expected nearer than this to the master's motion: a
  /// slave that follows its stream closely does not know that the stream itself is still behind.
  double max_button_error_m = 50e-6;
  control::BumplessTransferSettings approach{.rate_rad_per_s = 40.0, .max_acceleration_m_per_s2 = 5.0};
};

/// The master's tool, its own workpiece frame; the acceleration is the one commanded to it.
struct MasterSample {
  KinematicState tool;
  double beta = 1.0;
  std::uint32_t contour_id = 0;
  bool button = false;
  bool engaged = false;
  std::uint32_t engage = 0;         ///< engagements so far
  std::uint32_t stop = 0;           ///< number of the emergency stop in force; 0: none
  std::uint32_t echo_sequence = 0;  ///< newest state block that has come; 0: none
  std::int64_t echo_sent_ns = 0;    ///< its stamp, slave's clock
};

/// What the observer thinks; published for console, recorder and plots. Workpiece frame of the slave.
struct Observed {
  KinematicState slave;  ///< predicted for the tick at which the command made now acts
  Vec3 disturbance_m_per_s2 = Vec3::Zero();
  Vec3 innovation_m = Vec3::Zero();
  double delay_s = 0.0;
  bool aligned = false;  ///< engaged, and nothing is left of the approach to the master's motion
};

class CommandStream {
 public:
  CommandStream(const CommandStreamSettings& settings, std::uint32_t epoch);

  /// Every state, late ones too.
  void received(const streaming::Feedback& feedback) noexcept;
  /// Every control step. A block when one is full.
  std::optional<CommandBlock> step(std::int64_t now_ns, Tick tick, const MasterSample& master) noexcept;

  /// Another codec, block length or redundancy, from where the next block begins; the rate stays. Throws
  /// StartupError.
  void change(const codec::StreamSettings& codec);
  /// Goes on in the place of `before`, which is used up: for the slave it is one stream. Between two
  /// engagements; allocates nothing.
  void take_over(CommandStream& before) noexcept {
    packets_.take_over(before.packets_);
    engagement_.take_over(before.engagement_);  // else the first block of an engagement would be none
  }

  /// Copies of earlier blocks in the last packet.
  int copies() const noexcept { return packets_.copies(); }
  const Observed& observed() const noexcept { return observed_; }

 private:
  void begin_block(std::int64_t index, const MasterSample& master) noexcept;
  /// Where the new block begins: the model that its commands will move.
  void place_model(std::int64_t index, Engagement::Phase phase, bool rescaled,
                   const KinematicState& source) noexcept;
  Vec3 command(const KinematicState& source) noexcept;
  std::optional<CommandBlock> finish_block(std::int64_t now_ns, const MasterSample& master) noexcept;

  CommandStreamSettings settings_;
  double period_s_;
  NetworkObserver observer_;
  Engagement engagement_;
  streaming::Packetizer packets_;
  streaming::GapFinder gaps_;
  streaming::BurstFinder bursts_;
  streaming::RedundancyControl redundancy_;
  std::int64_t engaged_from_ = 0;  ///< index
  Observed observed_;
  std::uint32_t engage_ = 0;         ///< changes where blocks begin only
  std::uint32_t echo_sequence_ = 0;  ///< as the block began
  std::int64_t echo_sent_ns_ = 0;
  double beta_ = 1.0;           ///< changes where blocks begin only
  KinematicState model_;        ///< the commands' integral: the reference of a slave that follows the anchors
  KinematicState block_model_;  ///< where the block began
  std::int64_t next_index_ = -1;  ///< after the last sample; negative: none yet
  KinematicState commanded_;  ///< prediction with the command that acts on it, for the ticks between samples
};

}  // namespace telekerf::master
