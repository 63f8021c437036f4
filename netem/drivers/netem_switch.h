// SPDX-License-Identifier: Apache-2.0
// The event that puts another emulated network in place during a run, obeyed outside the control loop.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "common/bus/endpoints.h"
#include "common/bus/event_answers.h"
#include "common/recording/run_record.h"
#include "common/runtime/periodic.h"
#include "netem/drivers/receive_path_emulator.h"

namespace telekerf::netem {

/// Listens for EventMessage::Kind::kSetNetem, whose text names a profile, and switches this process'
/// receiving side. All of a cell switch or none does: whoever has the beam, the slave, decides for everyone, and the
/// others do what it says, also who comes later; without a slave in the cell each does as it is asked. A name that
/// cannot be loaded, a process that runs without emulation, and a beam that is on keep what there is; who asked is
/// told which it was.
class NetemSwitch {
 public:
  /// `emulator`: what stands in the process' receive path; null: nothing does.
  NetemSwitch(Bus& bus, std::shared_ptr<ReceivePathEmulator> emulator);

  /// For the slave's control loop, every step, wait-free: as long as the beam is on the network stays as it is.
  void beam(bool on) noexcept { beam_.store(on, std::memory_order_relaxed); }
  /// What has become of what was asked for, as figures `netem_...`.
  void add_figures(Metrics& figures) const;

 private:
  enum class Outcome : std::uint8_t { kSwitched, kBeamOn, kNotEmulated, kUnreadable, kRefusedBySlave };
  static constexpr std::size_t kOutcomes = 5;
  struct Verdict {
    Outcome outcome = Outcome::kSwitched;
    std::string text;  ///< why not; of a network that is in place, what is to be said of its recordings
  };

  void hear();
  /// Of whoever decides: which network is in place, to whom has come since.
  void tell_newcomers();
  void hear(const EventMessage& event);
  Verdict switch_to(const std::string& profile);

  Bus& bus_;
  const bool decides_;
  std::shared_ptr<ReceivePathEmulator> emulator_;
  std::atomic<bool> beam_{false};
  std::string profile_;  ///< that was put in place; empty: the one of the start
  std::string decided_;  ///< by somebody else
  static constexpr auto kNever = std::chrono::steady_clock::time_point::max();
  std::chrono::steady_clock::time_point again_at_ = kNever;
  int readers_ = 0;  ///< of the decisions
  std::array<std::atomic<std::uint64_t>, kOutcomes> counts_{};
  EventAnswers answers_;
  Reader<EventMessage> events_;
  Writer<EventMessage> decisions_;
  Periodic hearing_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf::netem
