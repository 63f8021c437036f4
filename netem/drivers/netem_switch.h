// SPDX-License-Identifier: Apache-2.0
// The event that puts another emulated network in place during a run, obeyed outside the control loop.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/endpoints.h"
#include "netem/drivers/receive_path_emulator.h"

namespace telekerf::netem {

/// Listens for EventMessage::Kind::kSetNetem, whose text names a profile, and switches this process'
/// receiving side. A name that cannot be loaded, or a process that runs without emulation, keeps what it has
/// and says so.
class NetemSwitch {
 public:
  /// `emulator`: what stands in the process' receive path; null: nothing does.
  NetemSwitch(Bus& bus, std::shared_ptr<ReceivePathEmulator> emulator)
      : role_(bus.settings().role),
        emulator_(std::move(emulator)),
        events_(bus),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

 private:
  void run(const std::stop_token& stop);
  /// What is to be said of the profile's recordings. Throws StartupError.
  std::string switch_to(const std::string& profile);

  std::string role_;
  std::shared_ptr<ReceivePathEmulator> emulator_;
  Reader<EventMessage> events_;
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf::netem
