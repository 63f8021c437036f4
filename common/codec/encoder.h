// SPDX-License-Identifier: Apache-2.0
// Sender's end of one stream: a block of samples in, a packet out.
#pragma once

#include <memory>
#include <span>

#include <tl/expected.hpp>

#include "common/codec/errors.h"
#include "common/codec/packet.h"
#include "common/codec/settings.h"

namespace telekerf::codec {

/// One stream of 3-axis samples. No allocation, lock or throw after construction. Closed loop: it decodes its
/// own block, and everything that it repeats later is the same integers, so a redundant copy decodes to the
/// same bits.
class BlockEncoder {
 public:
  /// Throws StartupError when the settings are out of bounds.
  explicit BlockEncoder(const StreamSettings& settings);
  ~BlockEncoder();
  BlockEncoder(BlockEncoder&&) noexcept;
  BlockEncoder& operator=(BlockEncoder&&) noexcept;

  /// One full block of N samples, oldest first. `button`: bit n at sample n. Writes the newest block and as
  /// many of the R previous ones as exist and fit; returns the packet's bytes. An error leaves the stream as
  /// it was, the refused block missing from it: the next packet then begins a new run of blocks.
  [[nodiscard]] tl::expected<std::size_t, CodecError> encode(std::span<const Vec3> samples,
                                                             std::uint64_t button, const Trend& trend,
                                                             std::span<std::uint8_t> out) noexcept;

  /// What every receiver decodes for the newest block, bit for bit; empty before the first.
  std::span<const Vec3> decoded() const noexcept;
  /// Bits that the last packet spent on its newest block: no head, no copies of previous ones.
  std::size_t newest_block_bits() const noexcept;
  const StreamSettings& settings() const noexcept;
  const CodecCounters& counters() const noexcept;
  /// Other settings from the next block on. The sequence goes on; copies of blocks coded under the old ones
  /// are not sent any more. Allocates nothing when the settings are in bounds; throws StartupError otherwise.
  void change(const StreamSettings& settings);
  /// So many previous blocks in each packet from the next one on, at most kMaxRedundancy; those that were
  /// coded already are among them.
  void repeat(int copies) noexcept;
  /// Previous blocks in the last packet.
  int copies() const noexcept;
  /// Forgets previous blocks (a gap in the stream); the sequence goes on.
  void restart() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace telekerf::codec
