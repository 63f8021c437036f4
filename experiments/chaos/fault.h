// SPDX-License-Identifier: Apache-2.0
// What can go wrong, and when it does: faults of a seed, as windows of time.
#pragma once

#include <cstdint>
#include <vector>

#include "common/runtime/enum_table.h"
#include "netem/core/profile.h"

namespace telekerf::experiments {

enum class FaultKind : std::uint8_t {
  kLoss,
  kReorder,
  kDuplicate,
  kCorrupt,
  kDelay,
  kOutageForward,
  kOutageBackward,
  kOutage,
  kSwizzle,
  kSlaveClock,
  kMasterClock,
  kSlaveAsleep,
  kMasterAsleep,
  kSlaveRestart,
  kMasterRestart,
  kContour,
  kImpostor,
  kBeta,
  kStop,
  kChatter,
  kSensorDropout,
  kSensorSlip,
  kSensorStuck,
  kLaserDeaf,
  kLaserStuck,
  kForger,
  kReplayer,
  kSecondMaster,
};

inline constexpr EnumRow<FaultKind> kFaultRows[] = {
    {"loss", FaultKind::kLoss, "datagrams are lost, 10 to 90 %, either way"},
    {"reorder", FaultKind::kReorder, "datagrams overtake others"},
    {"duplicate", FaultKind::kDuplicate, "datagrams come twice"},
    {"corrupt", FaultKind::kCorrupt, "datagrams are damaged, and their checksum tells"},
    {"delay", FaultKind::kDelay, "both ways become longer by 0.05 to 1.5 s"},
    {"outage-forward", FaultKind::kOutageForward, "nothing reaches the slave"},
    {"outage-backward", FaultKind::kOutageBackward, "nothing reaches the master"},
    {"outage", FaultKind::kOutage, "the link is down both ways"},
    {"swizzle", FaultKind::kSwizzle,
     "both ways and both processes clogged one by one, released in another order"},
    {"slave-clock", FaultKind::kSlaveClock,
     "the slave's clock runs up to 1000 ppm off, and every other time jumps"},
    {"master-clock", FaultKind::kMasterClock, "the same of the master's"},
    {"slave-asleep", FaultKind::kSlaveAsleep, "the slave is stopped as by SIGSTOP; what came waits for it"},
    {"master-asleep", FaultKind::kMasterAsleep, "the same of the master"},
    {"slave-restart", FaultKind::kSlaveRestart, "the slave ends and begins anew, all state lost"},
    {"master-restart", FaultKind::kMasterRestart, "the same of the master"},
    {"contour", FaultKind::kContour, "another contour is published"},
    {"impostor", FaultKind::kImpostor, "another contour is published under the id of the one in work"},
    {"beta", FaultKind::kBeta, "another scale is asked for"},
    {"stop", FaultKind::kStop, "somebody says stop, and later that it is over"},
    {"chatter", FaultKind::kChatter, "the button bounces"},
    {"sensor-dropout", FaultKind::kSensorDropout, "the slave's joints are not read for 1 to 60 ms"},
    {"sensor-slip", FaultKind::kSensorSlip, "a joint's sensor slips by 0.02 to 0.6 mm, for good"},
    {"sensor-stuck", FaultKind::kSensorStuck, "a joint's sensor tells the same for 2 to 300 ms"},
    {"laser-deaf", FaultKind::kLaserDeaf, "the laser does not hear what it is told"},
    {"laser-stuck", FaultKind::kLaserStuck, "the laser stays on, whatever it is told"},
    {"forger", FaultKind::kForger,
     "blocks with right checksum and epoch: button held, numbers counted up or at their end"},
    {"replayer", FaultKind::kReplayer, "recorded blocks come again, as they were or under another epoch"},
    {"second-master", FaultKind::kSecondMaster, "another master engages in the same cell"},
};
inline constexpr EnumTable<FaultKind> kFaults(kFaultRows);

/// One fault at work during [from_s, to_s).
struct FaultWindow {
  FaultKind kind = FaultKind::kLoss;
  double from_s = 0.0;
  double to_s = 0.0;
  double strength = 0.0;   ///< 0..1, drawn; what it means is the kind's own
  std::uint64_t word = 0;  ///< drawn, for choices within a kind

  bool holds(double now_s) const noexcept { return from_s <= now_s && now_s < to_s; }
};

/// What a seed brings: a network, and windows in order of their beginning.
struct Schedule {
  double rtt_s = 0.0;     ///< of the undisturbed link
  double jitter_s = 0.0;  ///< of it, one way
  std::vector<FaultKind> kinds;
  std::vector<FaultWindow> windows;
};

/// Kinds that a seed draws: a swarm, so that a kind is also tried without the others.
std::vector<FaultKind> drawn_kinds(std::uint64_t seed);

/// Windows of `kinds` that begin before `until_s`; none holds beyond it. Each kind draws by itself: dropping
/// another one, or an earlier end, changes nothing else.
Schedule draw_schedule(std::uint64_t seed, const std::vector<FaultKind>& kinds, double until_s);

/// The link as the schedule has it. `forward`: operator -> slave.
netem::DirectionProfile link_profile(const Schedule& schedule, bool forward);

}  // namespace telekerf::experiments
