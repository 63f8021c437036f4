// SPDX-License-Identifier: Apache-2.0
// The event that puts another emulated network in place during a run, obeyed outside the control loop.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "common/bus/endpoints.h"
#include "common/bus/event_answers.h"
#include "common/runtime/periodic.h"
#include "netem/drivers/receive_path_emulator.h"

namespace telekerf::netem {

/// Listens for EventMessage::Kind::kSetNetem, whose text names a profile, and switches this process'
/// receiving side. A name that cannot be loaded, a process that runs without emulation, and a beam that is on
/// keep what there is; who asked is told which it was.
class NetemSwitch {
 public:
  /// `emulator`: what stands in the process' receive path; null: nothing does.
  NetemSwitch(Bus& bus, std::shared_ptr<ReceivePathEmulator> emulator);

  /// For a control loop, every step, wait-free: as long as the beam is on the network stays as it is.
  void beam(bool on) noexcept { beam_.store(on, std::memory_order_relaxed); }

 private:
  void hear();
  /// What is to be said of the profile's recordings. Throws StartupError.
  std::string switch_to(const std::string& profile);

  std::string role_;
  std::shared_ptr<ReceivePathEmulator> emulator_;
  std::atomic<bool> beam_{false};
  EventAnswers answers_;
  Reader<EventMessage> events_;
  Periodic hearing_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf::netem
