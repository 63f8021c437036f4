// SPDX-License-Identifier: Apache-2.0
// What the console records of a run: the hand as it was sent to the master, and what was asked for and stopped.
#pragma once

#include <cstdint>
#include <utility>

#include "common/protocol/messages.h"
#include "common/recording/process_recording.h"
#include "master/operator/udp_hand.h"

namespace telekerf::master {

/// A frame of the hand.
struct HandRow {
  std::uint64_t tick = 0;  ///< its number
  double t_s = 0.0;
  std::uint32_t session = 0;
  bool held = false;
  bool trigger = false;
  double x_m = 0.0;  ///< where it pulls, on the contour as it was published
  double y_m = 0.0;
};
std::span<const Column<HandRow>> hand_columns();

class ConsoleRecording {
 public:
  /// Throws StartupError.
  ConsoleRecording(const RecordFlags& flags, RunIdentity identity, StatusReporter& status);
  void sent(const UdpHandFrame& frame);
  void sent(const EventMessage& event);
  void sent(const StopMessage& stop);
  void close(Metrics figures) { recording_.close({.figures = std::move(figures)}); }
  /// As ProcessRecording's.
  void refuse_unfinished() const { recording_.refuse_unfinished(); }

 private:
  enum Part : std::size_t { kHand, kOperator };
  void push(bool stop, std::uint32_t kind, std::uint32_t asker, double value);
  std::uint64_t asked_ = 0;
  ProcessRecording recording_;
};

}  // namespace telekerf::master
