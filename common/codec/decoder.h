// SPDX-License-Identifier: Apache-2.0
// Receiver's end of one stream: any bytes in, blocks of samples or an error value out.
#pragma once

#include <array>
#include <memory>
#include <span>

#include <tl/expected.hpp>

#include "common/codec/errors.h"
#include "common/codec/packet.h"

namespace telekerf::codec {

struct DecodedBlock {
  std::span<const Vec3> samples;  ///< N of them, oldest first; valid until the decoder's next call
  std::uint64_t button = 0;       ///< bit n: at sample n
};

struct DecodedPacket {
  PacketHead head;  ///< what the stream announces of itself
  int blocks = 0;   ///< newest first: blocks_newest_first[i] is i blocks older than the newest
  int block_size = 0;
  bool concealed = false;  ///< not received: extrapolated from the last packet by conceal()
  std::array<DecodedBlock, kMaxBlocks> blocks_newest_first;
};

/// Needs no configuration: streams announce themselves in each packet, and may change their settings at any
/// packet. No allocation, lock or throw after construction; never reads beyond `bytes`.
class BlockDecoder {
 public:
  BlockDecoder();
  ~BlockDecoder();
  BlockDecoder(BlockDecoder&&) noexcept;
  BlockDecoder& operator=(BlockDecoder&&) noexcept;

  /// `trend`: the one the encoder was given (zero for streams without). A packet whose sequence number is
  /// among the last 64 accepted ones is a replay and refused; one from further back counts as a restarted
  /// sender.
  [[nodiscard]] tl::expected<const DecodedPacket*, CodecError> decode(std::span<const std::uint8_t> bytes,
                                                                      const Trend& trend) noexcept;
  /// For a block that did not come in time: the stream's last motion, fading out over one block (anchored
  /// streams) or its last value (others), the button released, `concealed` set. Calls in a row go on from
  /// each other. nullptr before the first good packet. A copy that arrives later still decodes to the true
  /// samples.
  const DecodedPacket* conceal() noexcept;
  std::uint64_t concealed() const noexcept;
  const CodecCounters& counters() const noexcept;
  /// Forgets the sequence numbers seen and the motion to conceal with.
  void reset() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace telekerf::codec
