// SPDX-License-Identifier: Apache-2.0
// A station's ear and voice on the emergency stop: it stops in the thread that hears, tells who comes later,
// and keeps the stop in a file over a restart.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/endpoints.h"
#include "common/bus/stop_file.h"
#include "common/protocol/stop_talk.h"

namespace telekerf {

class Settings;

/// Where stops survive: "auto" is a file named after domain, cell and role in the user's state folder.
struct StopFlags {
  std::string stop_file = "auto";
  void add_parameters(Settings& settings);
  /// Empty: nowhere. Throws StartupError: nobody knows where.
  std::string path(const BusSettings& bus) const;
};

class StopLine {
 public:
  /// `path`: of the file; empty: none. Throws StartupError as StopFile.
  StopLine(Bus& bus, std::string path);

  /// For the control loop, every step: wait-free.
  StopOrder order() const noexcept;
  /// What the loop obeys at this step (0: none), which may have come by the other side's stream. Wait-free.
  void obeyed(std::uint32_t number) noexcept { obeyed_.store(number, std::memory_order_release); }
  /// In each step in which the operator's own device wants a stop: one of kDevice is in force from the next
  /// steps on, and anew if it is cleared meanwhile. Wait-free.
  void say() noexcept { said_.store(true, std::memory_order_release); }
  static constexpr const char* kDevice = "foot-switch";
  /// Who stopped and why, for people; empty: nobody.
  std::string sentence() const;

 private:
  void hear(const StopMessage& message);
  void publish();
  /// What is to be said now.
  std::vector<StopMessage> answers(bool said, std::uint32_t obeyed);
  void keep();
  void stop_here();
  /// What the loop reads from now on.
  void order_from_latch() noexcept;

  StopFile file_;
  mutable std::mutex mutex_;
  StopLatch latch_;
  std::uint32_t epoch_;
  StopReplies answers_;
  std::string kept_;                      ///< what the file holds
  std::atomic<bool> unsettled_{false};    ///< and the disk may not yet
  std::atomic<std::uint32_t> number_{0};  ///< of the order
  std::array<std::atomic<std::uint32_t>, std::tuple_size_v<decltype(StopOrder::cleared)>> cleared_{};
  std::atomic<std::uint32_t> obeyed_{0};
  std::atomic<bool> said_{false};
  Writer<StopMessage> writer_;
  Reader<StopMessage> reader_;
  std::jthread thread_, settler_;  ///< last: start when everything else is there, end first
};

}  // namespace telekerf
