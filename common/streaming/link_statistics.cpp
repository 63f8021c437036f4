// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/link_statistics.h"

#include <algorithm>

namespace telekerf::streaming {

namespace {

/// A listener stamps what comes between two looks of its loop at the clock.
constexpr std::int64_t kStampError_ns = 10'000'000;

}  // namespace

LinkStatistics::LinkStatistics() : histogram_(kBins, 0) {}

void LinkStatistics::sent(const CommandBlock& block, int copies) noexcept {
  ++packets_;
  copies_ += static_cast<std::uint64_t>(copies);
  max_copies_ = std::max(max_copies_, copies);
  payload_bytes_ += block.payload.size;
  wire_bytes_ += cost_(block);
}

bool LinkStatistics::received(const StateHeader& state, std::int64_t received_ns) noexcept {
  // One round trip a command: a later state that echoes the same command says nothing new.
  if (state.echo_sequence == 0 || state.echo_sequence == last_echo_) return true;
  last_echo_ = state.echo_sequence;
  const std::int64_t held_ns = state.sent_ns - state.echo_received_ns;
  const std::int64_t rtt_ns = received_ns - state.echo_sent_ns - held_ns;
  if (held_ns < -kStampError_ns || rtt_ns < -kStampError_ns) {
    ++clocks_wrong_;
    return false;
  }
  clocks_.add({state.echo_sent_ns, state.echo_received_ns, state.sent_ns, received_ns});
  last_received_ns_ = received_ns;
  const double rtt_ms = static_cast<double>(rtt_ns) * 1e-6;
  newest_rtt_s_ = rtt_ms * 1e-3;
  const double bin = std::clamp(rtt_ms / kBinMs, 0.0, static_cast<double>(kBins - 1));
  ++histogram_[static_cast<std::size_t>(bin)];
  ++round_trips_;
  return true;
}

double LinkStatistics::rtt_quantile_ms(double fraction) const {
  if (round_trips_ == 0) return 0.0;
  const double rank = fraction * static_cast<double>(round_trips_);
  std::size_t bin = 0;
  double seen = histogram_[0];
  while (seen < rank && bin + 1 < kBins) seen += histogram_[++bin];
  return (static_cast<double>(bin) + 0.5) * kBinMs;
}

}  // namespace telekerf::streaming
