// SPDX-License-Identifier: Apache-2.0
// The frame of every process of a cell: it joins, says what it does, and runs until it is done or a signal
// comes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/bus/lookout.h"
#include "common/bus/roll_call.h"
#include "common/protocol/events.h"
#include "common/runtime/loop.h"
#include "common/runtime/periodic.h"
#include "common/runtime/status_reporter.h"
#include "common/runtime/supervision.h"

namespace telekerf {

class Process {
 public:
  /// From now on signals end it in order. `who` begins what it says, `initial_state` need not be said. Throws
  /// StartupError if the cell does not take it, see Bus.
  Process(const BusSettings& settings, const std::string& who, const char* initial_state = nullptr);

  Bus& bus() noexcept { return bus_; }
  StatusReporter& status() noexcept { return status_; }
  /// What the loop misses is said by a thread of the process' own.
  Lookout& lookout() noexcept { return lookout_; }
  /// Wait-free: a loop other than run() says at every turn that it goes on; see Supervision.
  void alive() noexcept { supervision_.step(); }
  /// "cell 'cell-1' of domain 0"
  std::string place() const;

  /// Says that everything is there.
  void ready();
  /// Says so after its first turn, for locking the memory takes its time. Steps at `rate_hz` until `step`
  /// returns false, a signal comes, or this process' keys end.
  LoopStatistics run(double rate_hz, const std::function<bool(std::int64_t now_ns)>& step);
  /// Its keys have ended: nothing is to go on. Wait-free.
  bool ended() const noexcept { return ended_.load(std::memory_order_relaxed); }
  /// Before keys end that an engagement needs, an event more says to let go; room for it must be there. For a
  /// control loop.
  void let_go_with_keys(std::vector<EventMessage>& events) const noexcept {
    if (bus_.lets_go() && events.size() < events.capacity()) events.emplace_back();
  }
  /// Throws StartupError then.
  void refuse_ended() const;

 private:
  void look();

  Bus bus_;
  StatusReporter status_;
  Lookout lookout_;
  std::atomic<bool> ended_{false};
  std::atomic<bool> turns_{false};  ///< the loop of run()
  bool ready_said_ = false;         ///< by the thread that looks, or before that by whoever has no such loop
  Supervision supervision_;
  ClockTeller clock_;
  Periodic looking_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
