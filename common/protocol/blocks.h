// SPDX-License-Identifier: Apache-2.0
// The two streams between the sites: blocks of samples, commands one way and measured states the other.
// Positions are metres in the workpiece frame (x right, y up in the picture, z along the beam).
#pragma once

#include <cstdint>

#include "common/protocol/payload.h"
#include "common/runtime/vectors.h"

namespace telekerf {

/// Count of control steps of the side that made it. An overrun delays ticks and is counted; none is skipped.
using Tick = std::uint64_t;

/// Who computes the slave's acceleration: `local` streams the master's scaled position, the other two stream
/// accelerations.
enum class Law : std::uint8_t { kLocal, kAnchored, kRemoteAcceleration };

/// Absolute state at a block's first tick, so that no loss leaves an offset. Workpiece frame of the slave.
/// Single precision on the wire, as beta is: see wire_precision.h.
struct Anchor {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
};

/// What a command block says beside its samples.
struct CommandHeader {
  std::uint32_t sequence = 0;
  std::uint32_t epoch = 0;  ///< of the master process: a restarted master is a new one
  Tick first_tick = 0;      ///< master tick of the newest block's first sample
  std::uint32_t sample_period_ns = 0;
  std::uint16_t ticks_per_sample = 1;  ///< control steps between stream samples
  std::uint32_t contour_id = 0;
  double beta = 1.0;  ///< slave motion = beta x master motion
  Law law = Law::kLocal;
  bool engaged = false;             ///< false: the slave holds its pose, laser off
  std::uint8_t engaged_before = 0;  ///< bit n: of the block n + 1 before it, whose copy rides along; 0 too
                                    ///< where that had another beta
  std::uint64_t button = 0;         ///< bit n: laser button at sample n of the newest block
  Anchor anchor;                    ///< state at first_tick
  std::int64_t sent_ns = 0;         ///< sender's monotonic clock, when handed to the bus
  std::uint32_t engage = 0;         ///< counts the operator's engagements; each is followed once
  std::uint32_t stop = 0;           ///< number of the emergency stop that the master has latched; 0: none
  std::uint32_t echo_sequence =
      0;                          ///< of the newest state block that had come when the samples began; 0: none
  std::int64_t echo_sent_ns = 0;  ///< its stamp, slave's clock
};

/// Operator -> slave, best effort, one a block of N stream samples.
struct CommandBlock : CommandHeader {
  using Header = CommandHeader;
  Payload payload;
};

/// Laser interlock: the first reason that forbids the beam; kReady means the button decides.
enum class Interlock : std::uint8_t {
  kReady,
  kNoContour,
  kNotEngaged,
  kStale,
  kOutsideWorkspace,
  kOutsideCorridor,
  kTracking,   ///< tool too far from its reference
  kStopped,    ///< latched emergency stop
  kHeight,     ///< too far above or below the workpiece
  kSpeed,      ///< slower than the beam may be on, or faster than the robot's limit
  kDose,       ///< the place has got all the energy that it may
  kPower,      ///< more power than the work may have
  kPredicted,  ///< could leave the corridor within the reaction time
  kFault,      ///< a fault is latched
  kAge,        ///< the commands that arrive are too old
  kNotArmed,   ///< not engaged anew, or the button not let go, since the last stop, outage or start
  kMonitor,    ///< the second judgement forbids
  kArc,        ///< beside another part of the contour than expected
  kLate,       ///< a control step came late
};
inline constexpr Interlock kLastInterlock = Interlock::kLate;

/// The bit of StateHeader::guards that asks for a released button.
inline constexpr std::uint32_t kButtonGuard = 1U << 5U;

/// The one that is set where the commands are older than the slave lets light.
inline constexpr std::uint32_t kAgeGuard = 1U << 8U;

/// The bit of StateHeader::guards that is none: the laser is not simulated, so that nobody may light it who
/// is not there.
inline constexpr std::uint32_t kRealLaser = 1U << 31U;

enum class SlaveMode : std::uint8_t {
  kWaiting,    ///< no commands yet, or disengaged: holds its pose
  kFollowing,  ///< applies the stream
  kHolding,    ///< was following, but what came is no longer good enough: holds, laser off
  kStopped,    ///< latched emergency stop
};

/// Why a slave does not follow.
enum class HoldReason : std::uint8_t {
  kNone,         ///< it follows
  kNoCommands,   ///< none has come yet
  kNotEngaged,   ///< the master does not lead
  kNeedsEngage,  ///< led by an engagement from before a stop, outage, fault, other contour or restart
  kSilent,       ///< no commands arrive any more
  kTooOld,       ///< they arrive, but too old to be followed
  kClockWrong,   ///< they echo no state of this slave, so nobody knows how old they are
  kLimits,       ///< they lead out of the robot's bounds
  kStopped,      ///< emergency stop
};

/// What a state block says beside its samples.
struct StateHeader {
  std::uint32_t sequence = 0;
  std::uint32_t epoch = 0;         ///< of the slave process
  std::uint32_t master_epoch = 0;  ///< whose commands it follows
  Tick first_tick = 0;             ///< slave tick of the newest block's first sample
  std::uint32_t sample_period_ns = 0;
  std::uint16_t ticks_per_sample = 1;  ///< control steps between stream samples
  std::uint32_t contour_id = 0;
  double beta = 1.0;
  Anchor anchor;  ///< measured state at first_tick
  Interlock interlock = Interlock::kNoContour;
  bool laser_on = false;
  // Echo of the commands: what was applied at the block's last sample.
  Tick applied_tick = 0;                ///< newest master tick applied
  std::uint32_t applied_age_ticks = 0;  ///< slave ticks since it was applied (0: just now)
  std::uint64_t applied_bitmap = 0;     ///< bit n: master tick applied_tick - n was really applied
  std::int32_t playout_ticks = 0;       ///< depth of the play-out buffer, in stream samples
  // Clock stamps of the newest command received: sent (master's clock), received and answered (slave's
  // clock).
  std::uint32_t echo_sequence = 0;
  std::int64_t echo_sent_ns = 0;
  std::int64_t echo_received_ns = 0;
  std::int64_t sent_ns = 0;
  SlaveMode mode = SlaveMode::kWaiting;
  HoldReason reason = HoldReason::kNoCommands;
  std::uint32_t engage = 0;     ///< engagements up to this one are not followed any more
  std::uint32_t stop = 0;       ///< number of the emergency stop that is obeyed; 0: none
  Tick stop_tick = 0;           ///< slave tick since which it is
  std::uint32_t guards = 0;     ///< bit n: guard n forbids the beam (slave/laser/guards.h); kRealLaser
  double command_age_s = -1.0;  ///< of the command whose turn it is, by the slave's own clock; negative: none
};

/// Slave -> operator, best effort, one a block of N stream samples of the measured tool position and of the
/// force on the tool.
struct StateBlock : StateHeader {
  using Header = StateHeader;
  Payload payload;
  Payload force;  ///< the same samples: estimated force of the world on the tool, N; empty: not sent
};

}  // namespace telekerf
