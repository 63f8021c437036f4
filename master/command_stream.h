// SPDX-License-Identifier: Apache-2.0
// From the master's motion to command blocks (eq. 79-96): who computes the slave's acceleration (the law), on
// which idea of the slave's state (the network observer), and what the wire carries of it.
#pragma once

#include <optional>
#include <vector>

#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/control/bumpless_transfer.h"
#include "common/protocol/messages.h"
#include "master/observer/network_observer.h"

namespace telekerf::master {

struct CommandStreamSettings {
  Law law = Law::kAnchored;
  ObserverSettings observer;
  codec::StreamSettings codec;
  int ticks_per_sample = 1;
  double tracking_rad_s = 150.0;  ///< w of the law, critically damped: K_v = 2 w, K_p = w^2
  double timing_error_s = 1e-3;   ///< of the slave's answer, to be borne when the loop spans the delay
  double max_acceleration_m_per_s2 = 10.0;  ///< of a command; what is stored is what was clipped
  Vec3 wrong_position_m = Vec3::Zero();     ///< by which the first idea of the slave is wrong, for trials
  Vec3 wrong_velocity_m_per_s = Vec3::Zero();
  control::BumplessTransferSettings approach{.rate_rad_s = 20.0, .max_acceleration_m_per_s2 = 1.0};
};

/// The master's tool, its own workpiece frame; the acceleration is the one commanded to it.
struct MasterMotion {
  KinematicState tool;
  double beta = 1.0;
  std::uint32_t contour_id = 0;
  bool button = false;
  bool engaged = false;
};

/// What the observer thinks; published for console, recorder and plots. Workpiece frame of the slave.
struct Observed {
  KinematicState slave;  ///< predicted for the tick at which the command made now acts
  Vec3 disturbance_m_per_s2 = Vec3::Zero();
  Vec3 innovation_m = Vec3::Zero();
  double delay_s = 0.0;
  bool joined = false;  ///< engaged, and nothing is left of the approach to the master's motion
};

class CommandStream {
 public:
  CommandStream(const CommandStreamSettings& settings, std::uint32_t epoch);

  void received(const StateBlock& state) noexcept;
  /// Every control step. A block when one is full.
  std::optional<CommandBlock> step(std::int64_t now_ns, Tick tick, const MasterMotion& master) noexcept;

  /// Another codec, block length or redundancy, from where the next block begins; the rate stays. Throws
  /// StartupError.
  void change(const codec::StreamSettings& codec);

  const Observed& observed() const noexcept { return observed_; }

 private:
  void begin_block(std::int64_t index, const MasterMotion& master) noexcept;
  double bandwidth() const noexcept;
  Vec3 command(const KinematicState& goal) const noexcept;
  std::optional<CommandBlock> finish_block(std::int64_t now_ns, const MasterMotion& master) noexcept;

  CommandStreamSettings settings_;
  std::uint32_t epoch_;
  double period_s_;
  std::optional<codec::StreamSettings> next_codec_;
  codec::BlockEncoder encoder_;
  codec::BlockDecoder decoder_;
  NetworkObserver observer_;
  Observed observed_;

  // The block being filled.
  std::vector<Vec3> samples_;
  std::size_t filled_ = 0;
  std::int64_t block_index_ = 0;
  std::uint64_t buttons_ = 0;
  Anchor anchor_;
  std::uint32_t number_ = 0;
  bool engaged_ = false;             ///< changes where blocks begin only, as beta does
  std::uint8_t engaged_before_ = 0;  ///< bit n: so was the block n + 1 back, at this beta
  double beta_ = 1.0;

  KinematicState model_;        ///< the commands' integral: the reference of a slave that follows the anchors
  KinematicState block_model_;  ///< where the block began
  KinematicState commanded_;  ///< prediction with the command that acts on it, for the ticks between samples
  control::BumplessTransfer approach_;
  bool seated_ = false;  ///< the approach was seated at this very sample

  // The slave's side as its states tell it.
  std::vector<SlaveSample> arrived_;
  std::uint32_t slave_epoch_ = 0;
  std::uint32_t state_number_ = 0;
  std::uint32_t state_period_ns_ = 0;
  std::uint16_t state_ticks_ = 0;  ///< slave's control steps between its samples
  std::int64_t slave_index_ = -1;  ///< newest sample taken, in the slave's own count
  std::optional<Vec3> slave_at_m_;
  int unheeded_ = 0;                ///< samples since it applied anything, while engaged
  std::int64_t engaged_index_ = 0;  ///< where the engagement began
  std::int64_t resume_index_ = 0;   ///< let go until then
};

}  // namespace telekerf::master
