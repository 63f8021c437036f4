// SPDX-License-Identifier: Apache-2.0
// What the link does, seen from the master: round trips, clocks, payload. Fixed memory, no allocation in the
// loop.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/protocol/messages.h"
#include "common/protocol/overhead.h"
#include "common/streaming/clock_offset_estimator.h"

namespace telekerf::streaming {

class LinkStatistics {
 public:
  LinkStatistics();

  /// `copies`: earlier blocks in its packet.
  void sent(const CommandBlock& block, int copies) noexcept;
  /// A state that the receiver did not refuse, whatever its order. Round trip of the network only: handing a
  /// command to the bus until taking the state that acknowledges it, less the time that the slave held it.
  /// False: its stamps cannot be, one of the two clocks is wrong; it says nothing about the link then.
  bool received(const StateHeader& state, std::int64_t received_ns) noexcept;

  double rtt_quantile_ms(double fraction) const;
  /// Of the newest command that was answered; 0: none yet.
  double newest_rtt_s() const noexcept { return newest_rtt_s_; }
  std::uint64_t round_trips() const noexcept { return round_trips_; }
  /// Answers that came before they were asked for, or were held for less than no time.
  std::uint64_t clocks_wrong() const noexcept { return clocks_wrong_; }
  /// The slave's clock against ours, as of the newest state.
  ClockEstimate clocks() const noexcept { return clocks_.estimate(last_received_ns_); }
  std::uint64_t packets() const noexcept { return packets_; }
  std::uint64_t payload_bytes() const noexcept { return payload_bytes_; }
  /// Of whole frames.
  std::uint64_t wire_bytes() const noexcept { return wire_bytes_; }
  double mean_copies() const noexcept {
    return packets_ == 0 ? 0.0 : static_cast<double>(copies_) / static_cast<double>(packets_);
  }
  int max_copies() const noexcept { return max_copies_; }

 private:
  static constexpr double kBinMs = 0.02;
  static constexpr std::size_t kBins = 150'000;  ///< 3 s; longer ones fall into the last
  std::vector<std::uint32_t> histogram_;
  std::uint64_t round_trips_ = 0;
  std::uint64_t clocks_wrong_ = 0;
  double newest_rtt_s_ = 0.0;
  ClockOffsetEstimator clocks_;
  std::int64_t last_received_ns_ = 0;
  std::uint32_t last_echo_ = 0;
  std::uint64_t packets_ = 0;
  std::uint64_t payload_bytes_ = 0;
  std::uint64_t wire_bytes_ = 0;
  WireCost<CommandBlock> cost_;
  std::uint64_t copies_ = 0;
  int max_copies_ = 0;
};

}  // namespace telekerf::streaming
