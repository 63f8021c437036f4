// SPDX-License-Identifier: Apache-2.0
// The event that puts another emulated network in place during a run, obeyed outside the control loop.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "common/bus/endpoints.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// Listens for EventMessage::Kind::kSetNetem, whose text names a profile, and switches this process'
/// receiving side. A name that cannot be loaded, or a process that runs without emulation, keeps what it has
/// and says so.
class NetemSwitch {
 public:
  explicit NetemSwitch(Bus& bus)
      : bus_(bus), events_(bus), thread_([this](const std::stop_token& stop) { run(stop); }) {}

 private:
  void run(const std::stop_token& stop);

  Bus& bus_;
  Reader<EventMessage> events_;
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
