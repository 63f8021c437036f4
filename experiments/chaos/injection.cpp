// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/injection.h"

#include "experiments/chaos/operator_script.h"
#include "netem/core/random.h"

namespace telekerf::experiments {
namespace {

/// A bouncing contact is looked at this often.
constexpr std::int64_t kBounce_ns = 7'000'000;

double sign_of(const FaultWindow& window) noexcept { return (window.word & 2U) != 0 ? 1.0 : -1.0; }

void disturb(SiteTime& site, std::int64_t now_ns, const FaultWindow& window) {
  // CLOCK_MONOTONIC never goes back; a suspended machine's may leap.
  const double jump_s = (window.word & 1U) != 0 ? 0.02 + 2.0 * window.strength : 0.0;
  site.clock.change(now_ns, 1.0 + 1e-3 * sign_of(window) * window.strength, jump_s);
}

}  // namespace

void Injection::turn(std::int64_t now_ns, World& world) {
  attacks_.clear();
  for (std::size_t i = 0; i < begun_.size(); ++i) {
    const FaultWindow& window = schedule_.windows[i];
    if (!begun_[i] && ns(window.from_s) <= now_ns) {
      begun_[i] = true;
      begin(now_ns, window, world);
    }
    if (!begun_[i] || ended_[i]) continue;
    if (ns(window.to_s) <= now_ns) {
      ended_[i] = true;
      end(now_ns, window, world);
      continue;
    }
    if (window.kind == FaultKind::kForger || window.kind == FaultKind::kReplayer) attacks_.push_back(window);
    if (window.kind == FaultKind::kChatter) {
      const auto slot = static_cast<std::uint64_t>(now_ns / kBounce_ns);
      world.bounce((netem::mixed(slot ^ window.word) & 1U) != 0);
    }
  }
}

void Injection::begin(std::int64_t now_ns, const FaultWindow& window, World& world) {
  SlaveSite& slave = world.slave();
  switch (window.kind) {
    case FaultKind::kSlaveClock:
      return disturb(slave.time, now_ns, window);
    case FaultKind::kMasterClock:
      return disturb(world.master().time, now_ns, window);
    case FaultKind::kOutage:
    case FaultKind::kOutageForward:
      return world.clog(1);
    case FaultKind::kSlaveAsleep:
    case FaultKind::kMasterAsleep:
      return world.put_to_sleep(window.kind == FaultKind::kSlaveAsleep, now_ns);
    case FaultKind::kSlaveRestart:
      return world.end_slave(now_ns, ns(window.to_s));
    case FaultKind::kMasterRestart:
      return world.end_master(ns(window.to_s));
    case FaultKind::kContour:
      return world.swap_contour(now_ns);
    case FaultKind::kImpostor:
      return world.publish_impostor(now_ns);
    case FaultKind::kBeta:
      return world.say(scale_event(0.35 + 0.65 * window.strength));
    case FaultKind::kStop:
      return world.say_stop(now_ns, true);
    case FaultKind::kSensorDropout:
      slave.sensor.dropout = true;
      return;
    case FaultKind::kSensorStuck:
      slave.sensor.stuck = true;
      return;
    case FaultKind::kSensorSlip:
      slave.sensor.slip_m[static_cast<int>(window.word % 3)] +=
          sign_of(window) * (2e-5 + 5.8e-4 * window.strength);
      return;
    case FaultKind::kLaserDeaf:
      slave.laser.deaf = true;
      return;
    case FaultKind::kLaserStuck:
      slave.laser.stuck = true;
      return;
    case FaultKind::kSecondMaster:
      return world.begin_second(now_ns);
    default:
      return;
  }
}

void Injection::end(std::int64_t now_ns, const FaultWindow& window, World& world) {
  SlaveSite& slave = world.slave();
  switch (window.kind) {
    case FaultKind::kSlaveClock:
      return slave.time.clock.change(now_ns, 1.0, 0.0);
    case FaultKind::kMasterClock:
      return world.master().time.clock.change(now_ns, 1.0, 0.0);
    case FaultKind::kOutage:
    case FaultKind::kOutageForward:
      return world.clog(-1);
    case FaultKind::kSlaveAsleep:
    case FaultKind::kMasterAsleep:
      return world.wake(window.kind == FaultKind::kSlaveAsleep, now_ns, ns(window.from_s));
    case FaultKind::kStop:
      return world.say_stop(now_ns, false);
    case FaultKind::kChatter:
      return world.bounce(false);
    case FaultKind::kSensorDropout:
      slave.sensor.dropout = false;
      return;
    case FaultKind::kSensorStuck:
      slave.sensor.stuck = false;
      return;
    case FaultKind::kLaserDeaf:
      slave.laser.deaf = false;
      return;
    case FaultKind::kLaserStuck:
      slave.laser.stuck = false;
      return;
    case FaultKind::kSecondMaster:
      return world.end_second();
    default:
      return;
  }
}

}  // namespace telekerf::experiments
