// SPDX-License-Identifier: Apache-2.0
// The sending end of a stream, either direction: samples in, one a step; numbered blocks out, coded, each
// with its anchor.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/codec/encoder.h"
#include "common/protocol/messages.h"

namespace telekerf::streaming {

struct PacketizerSettings {
  codec::StreamSettings codec;
  int ticks_per_sample = 1;
  std::uint32_t sample_period_ns = 1'000'000;
  std::uint32_t epoch = 1;  ///< of the sending process
};

/// No allocation, lock or throw after construction, change() aside.
class Packetizer {
 public:
  /// Throws StartupError.
  explicit Packetizer(const PacketizerSettings& settings);

  /// No sample of the next block has come yet: begin() is due.
  bool at_beginning() const noexcept { return filled_ == 0; }
  /// Before a block's first sample, which has the stream index `index`. `anchor`: the state there, as the
  /// wire carries it.
  void begin(std::int64_t index, const Anchor& anchor) noexcept;
  /// What is filled of the block is never sent: its samples would not follow each other.
  void abandon() noexcept { filled_ = 0; }
  /// True: the block is full, pack() is due.
  bool add(const Vec3& sample, bool button) noexcept;
  /// All that any stream's block says: number, epoch, time, anchor, samples. False: the samples cannot be
  /// coded and nothing is to be sent; the number is used up, and the next block stands alone.
  template <class Block>
  bool pack(std::int64_t now_ns, Block& block) noexcept {
    block.sequence = ++number_;
    block.epoch = settings_.epoch;
    block.first_tick = static_cast<Tick>(index_) * static_cast<Tick>(settings_.ticks_per_sample);
    block.sample_period_ns = settings_.sample_period_ns;
    block.ticks_per_sample = static_cast<std::uint16_t>(settings_.ticks_per_sample);
    block.anchor = anchor_;
    block.sent_ns = now_ns - now_ns % 1000;  // whole microseconds take fewer bytes
    return encode(block.payload);
  }
  /// The samples alone, for a part that rides on another packetizer's blocks.
  bool encode(Payload& payload) noexcept;

  /// Other settings of the codec from where the next block begins; rate and kind of anchor stay. Throws
  /// StartupError.
  void change(const codec::StreamSettings& codec);

  /// Goes on in the place of `before`, which is used up: for the receiver it is one stream whose settings
  /// change. The next block stands alone.
  void take_over(Packetizer& before) noexcept;

  /// Copies of earlier blocks in each packet from the next one on.
  void repeat(int copies) noexcept { encoder_.repeat(copies); }
  /// In the last packet.
  int copies() const noexcept { return encoder_.copies(); }

  /// Samples a block.
  int block() const noexcept { return settings_.codec.block; }
  /// Of the block being filled, or of the last one that was packed.
  std::int64_t index() const noexcept { return index_; }
  std::uint64_t buttons() const noexcept { return buttons_; }
  /// What every receiver decodes of the last block that was packed.
  std::span<const Vec3> decoded() const noexcept { return encoder_.decoded(); }

 private:
  PacketizerSettings settings_;
  std::optional<codec::StreamSettings> next_;
  codec::BlockEncoder encoder_;
  std::array<Vec3, codec::kMaxBlock> samples_;
  std::size_t filled_ = 0;
  std::int64_t index_ = 0;
  std::uint64_t buttons_ = 0;  ///< bit n: at sample n
  Anchor anchor_;
  std::uint32_t number_ = 0;
};

}  // namespace telekerf::streaming
