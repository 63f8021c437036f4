// SPDX-License-Identifier: Apache-2.0
// What the processes say to each other, as domain types: the nodes and the virtual-time lap know these only.
// Positions are metres in the workpiece frame (x right, y up in the picture, z along the beam).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf {

/// Count of control steps of the side that made it (contract.md, "Time").
using Tick = std::uint64_t;

/// Who computes the slave's acceleration (observer.md): `local` streams the master's scaled position,
/// the other two stream accelerations.
enum class Law : std::uint8_t { kLocal, kAnchored, kRemoteAcceleration };

/// Absolute state at a block's first tick, so that no loss leaves an offset. Workpiece frame of the slave.
/// Single precision on the wire, as beta is: see wire_precision.h.
struct Anchor {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
};

/// Coded samples, as the codec wrote them.
struct Payload {
  static constexpr std::size_t kCapacity = 2048;
  std::array<std::uint8_t, kCapacity> bytes{};
  std::uint16_t size = 0;

  std::span<const std::uint8_t> view() const { return {bytes.data(), size}; }
  std::span<std::uint8_t> room() { return bytes; }
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
  kTracking,  ///< tool too far from its reference
  kStopped,   ///< latched emergency stop
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
};

/// Slave -> operator, best effort, one a block of N stream samples of the measured tool position and of the
/// force on the tool.
struct StateBlock : StateHeader {
  using Header = StateHeader;
  Payload payload;
  Payload force;  ///< the same samples: estimated force of the world on the tool, N; empty: not sent
};

/// Vision -> everyone, latched and reliable. Points in drawing order; a closed contour does not repeat its
/// first.
/// Bounds of a published contour (telekerf.idl).
inline constexpr std::size_t kMostContourPoints =
    100000;  ///< of the contour, and of all further lines together
inline constexpr std::size_t kMostContourLines = 1000;

struct ContourLine {
  bool closed = true;
  std::vector<Vec2> points_m;
};

struct ContourMessage {
  std::uint32_t id = 0;
  bool closed = true;
  std::string source;  ///< file or camera
  std::string mode;    ///< outline, stroke or thesis
  double metres_per_pixel = 0.0;
  double deviation_m = 0.0;  ///< quality record: estimated noise of the points, rms
  std::vector<Vec2> points_m;
  std::vector<ContourLine> further;  ///< the picture's other contours: a hand follows one, a machine cuts all
};

/// Modes and events, reliable.
struct EventMessage {
  enum class Kind : std::uint8_t { kEngage, kDisengage, kStop, kClearStop, kSetBeta, kFinished, kSetNetem };
  std::uint32_t epoch = 0;
  Kind kind = Kind::kDisengage;
  double value = 0.0;
  std::string text;
};

/// Slow named numbers of one process, for console and recorder.
struct TelemetryMessage {
  std::string role;
  Tick tick = 0;
  std::vector<std::pair<std::string, double>> values;
};

/// Who a process is; every participant announces it and `Bus` keeps the list of the others.
struct PresenceMessage {
  std::uint16_t contract = 0;
  std::string cell;
  std::string role;  ///< master, slave, vision, console, ...
  std::string name;  ///< unique in the cell
  std::uint32_t epoch = 0;
  bool joined = false;  ///< false while it looks around before joining
  std::string version;
};

/// A message as the bus hands it over.
template <class T>
struct Received {
  T value{};
  std::int64_t received_ns = 0;  ///< CLOCK_MONOTONIC of this machine, when the middleware handed it over
};

}  // namespace telekerf
