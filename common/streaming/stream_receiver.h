// SPDX-License-Identifier: Apache-2.0
// The receiving end of a stream, either direction: whose blocks are taken, which of them are new, late, lost
// or refused, and their samples decoded. The one place that judges order and epoch.
#pragma once

#include <cstdint>
#include <optional>

#include "common/codec/decoder.h"
#include "common/protocol/messages.h"

namespace telekerf::streaming {

/// What one received block is to the stream.
struct Arrival {
  enum class Kind : std::uint8_t {
    kNew,      ///< the newest block so far
    kLate,     ///< a newer one has overtaken it, but its samples are still of use
    kStale,    ///< repeated, or too late to be of use
    kRefused,  ///< undecodable, another sender's, for another contour, from the future
  };
  Kind kind = Kind::kRefused;
  bool begins = false;        ///< another sender or sample rate: nothing that was before counts any more
  std::uint32_t missing = 0;  ///< blocks between the last new one and this new one
  std::int64_t first = 0;     ///< stream index of the block's first sample
  const codec::DecodedPacket* packet = nullptr;  ///< of what is new or late, until the next receive()
};

struct StreamCounters {
  std::uint64_t blocks = 0;   ///< taken
  std::uint64_t lost = 0;     ///< blocks whose number never came
  std::uint64_t stale = 0;    ///< repeated, or too late
  std::uint64_t refused = 0;  ///< undecodable, other contour, other sender, from the future
};

/// Stream index = tick / ticks per sample, of the sender. Numbers may wrap around. No allocation, lock or
/// throw after construction.
template <class Block>
class StreamReceiver {
 public:
  using Header = typename Block::Header;

  /// `silence_s`: another sender is taken only after nothing has come for this long; until then it knocks in
  /// vain.
  explicit StreamReceiver(double silence_s) : silence_s_(silence_s) {}

  /// `useful_from`: an overtaken block that ends before this index is stale. `contour_id`: of the contour
  /// that is worked on here; blocks for another one are refused. `answers`: the block's sender has heard this side
  /// since it was started. The first that does is listened to at once: what was heard before may be a recording.
  Arrival receive(const Received<Block>& received, std::int64_t useful_from,
                  std::optional<std::uint32_t> contour_id = {}, bool answers = false) noexcept;

  /// A block has come since the start, and since another sender began to be listened to.
  bool heard() const noexcept { return heard_; }
  /// Of the newest block; what it says holds for the stream.
  const Header& header() const noexcept { return header_; }
  /// Index of the newest sample.
  std::int64_t newest() const noexcept { return newest_; }
  /// When the newest block came, this machine's clock.
  std::int64_t arrived_ns() const noexcept { return arrived_ns_; }
  double silent_s(std::int64_t now_ns) const noexcept {
    return static_cast<double>(now_ns - arrived_ns_) * 1e-9;
  }
  /// Within the last `silence_s` something came of another sender, which is not listened to: a rival, or a sender that
  /// has been started anew.
  bool contested(std::int64_t now_ns) const noexcept {
    return foreign_ns_ && static_cast<double>(now_ns - *foreign_ns_) * 1e-9 <= silence_s_;
  }
  /// Counts whatever makes samples incomparable: sender, rate, scale, law. 0 before the first block.
  std::uint32_t generation() const noexcept { return generation_; }
  const StreamCounters& counters() const noexcept { return counters_; }
  const codec::CodecCounters& codec_counters() const noexcept { return decoder_.counters(); }

 private:
  Arrival refuse() noexcept;
  void begin_anew() noexcept;
  /// Of what the time that has passed allows, in numbers or ticks.
  bool too_far_ahead(const Header& header, std::int64_t first, std::int64_t now_ns) const noexcept;
  Arrival overtaken(const Block& block, std::int64_t useful_from) noexcept;

  double silence_s_;
  codec::BlockDecoder decoder_;
  Header header_;
  std::uint32_t first_sequence_ = 0;  ///< since the stream began; what is older was never lost
  std::int64_t newest_ = -1;          ///< index of the newest sample
  int block_size_ = 1;                ///< samples in the newest block
  std::int64_t arrived_ns_ = 0;
  std::optional<std::int64_t> foreign_ns_;  ///< when another sender's block came, since this one is listened to
  bool heard_ = false;
  bool answered_ = false;  ///< the stream that is listened to has come from a sender that hears this side
  std::uint32_t generation_ = 0;
  StreamCounters counters_;
};

extern template class StreamReceiver<CommandBlock>;
extern template class StreamReceiver<StateBlock>;

}  // namespace telekerf::streaming
