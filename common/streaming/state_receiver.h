// SPDX-License-Identifier: Apache-2.0
// The master's end of the state stream: each block checked and decoded once, its samples for whoever needs
// them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/streaming/acknowledgement.h"
#include "common/streaming/packet_samples.h"
#include "common/streaming/slave_sample.h"
#include "common/streaming/stream_receiver.h"

namespace telekerf::streaming {

/// What one state block brought. Valid until the next one is received.
struct Feedback {
  Arrival::Kind kind = Arrival::Kind::kRefused;
  std::uint32_t number = 0;              ///< of the block
  bool begins = false;                   ///< another slave or sample rate: nothing from before goes on
  bool ours = false;                     ///< the slave follows this master's commands
  std::span<const SlaveSample> samples;  ///< not had before, in the order of the slave's clock
  std::optional<PacketSamples> force_n;  ///< by the slave's count of samples; none: not sent, or undecodable
};

/// No allocation, lock or throw after construction.
class StateReceiver {
 public:
  /// `silence_s`: another slave is listened to only after the last one has been silent for this long.
  /// `epoch`, `ticks_per_sample`: of this master's command stream.
  StateReceiver(double silence_s, std::uint32_t epoch, int ticks_per_sample);

  /// Order counts: a block that a newer one has overtaken brings nothing.
  const Feedback& receive(const Received<StateBlock>& received) noexcept;

  bool heard() const noexcept { return stream_.heard(); }
  /// Of the newest block.
  const StateHeader& header() const noexcept { return stream_.header(); }
  double silent_s(std::int64_t now_ns) const noexcept { return stream_.silent_s(now_ns); }
  bool contested(std::int64_t now_ns) const noexcept { return stream_.contested(now_ns); }
  const StreamCounters& counters() const noexcept { return stream_.counters(); }
  /// Refused payloads by reason: positions, forces.
  const codec::CodecCounters& position_counters() const noexcept { return stream_.codec_counters(); }
  const codec::CodecCounters& force_counters() const noexcept { return force_decoder_.counters(); }

 private:
  void take_samples(const PacketSamples& positions) noexcept;

  std::uint32_t epoch_;
  int ticks_per_sample_;
  StreamReceiver<StateBlock> stream_;
  codec::BlockDecoder force_decoder_;
  std::uint32_t force_epoch_ = 0;
  std::vector<SlaveSample> samples_;
  std::int64_t newest_ = -1;  ///< newest sample handed on, in the slave's own count
  Feedback feedback_;
};

}  // namespace telekerf::streaming
