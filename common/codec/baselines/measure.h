// SPDX-License-Identifier: Apache-2.0
// Sends a trace through a coded stream offline and counts everything: bits, bytes on the wire, error, delay,
// loss.
#pragma once

#include <cstdint>

#include "common/codec/baselines/trace.h"
#include "common/codec/settings.h"

namespace telekerf::codec {

/// Gilbert-Elliott: every packet of a burst is lost, none between bursts.
struct PacketLoss {
  double loss = 0.0;   ///< fraction of packets lost in the long run, [0, 0.9]
  double burst = 1.0;  ///< mean length of a burst, packets, at least 1
  std::uint64_t seed = 1;
};

struct CodingResult {
  std::size_t samples = 0;  ///< coded, each column; an incomplete last block is left out
  std::size_t packets = 0;
  std::size_t lost = 0;
  std::size_t refused_blocks = 0;     ///< NaN, Inf or out of range
  std::size_t concealed_samples = 0;  ///< made up because no copy came
  double bits_per_sample = 0;         ///< the coded blocks alone: no head, no copies, no anchor
  double packet_bytes = 0;            ///< mean payload: head, newest block and copies
  double copies = 0;                  ///< mean, of earlier blocks in a packet: those that fit
  double packets_per_s = 0;
  double frame_bytes = 0;           ///< mean, of a packet with everything around it (overhead.h)
  double wire_bytes_per_s = 0;      ///< of frames
  double raw_wire_bytes_per_s = 0;  ///< one packet of bare float32 a sample, with kDatagramBytes
  double rmse = 0;                  ///< over everything that was not refused, concealed samples included
  double max_error = 0;
  double velocity_rmse = 0;        ///< of first differences times the rate, block edges included
  double latency_ms = 0;           ///< waiting for a block to fill: (N - 1) sample periods
  double recovery_latency_ms = 0;  ///< more waiting until the last copy came: R N sample periods
  double encode_ns = 0;            ///< median, a block of up to three columns
  double decode_ns = 0;            ///< median, a packet
};

/// Columns travel in threes, one stream each. `decoded` (optional) takes what the receiver has in the end.
/// With settings.anchored the trend is what a sender knows at the block's first sample: its value and the
/// slope of the last samples. Dead-band codecs with a block of 1 send packets only when a sample leaves the
/// band. Throws StartupError.
CodingResult measure(const Trace& trace, StreamSettings settings, const PacketLoss& link = {},
                     Trace* decoded = nullptr);

/// Which of `packets` are lost.
std::vector<bool> lose(std::size_t packets, const PacketLoss& link);

}  // namespace telekerf::codec
