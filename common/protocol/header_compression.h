// SPDX-License-Identifier: Apache-2.0
// A stream's blocks in as few bytes as will do, as robust header compression does it (RFC 5795; least
// significant bits in a window, RFC 3095, 4.5.2): what stays the same travels seldom, what moves on travels
// in its lowest bytes, and the checksum is of the block as it was *before*, so that nothing restored wrongly
// is ever taken for a block.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/protocol/block_fields.h"
#include "common/protocol/verdict.h"

namespace telekerf {

/// A block carries its set after so many samples (of 16 a block: with every number that is a multiple of 32),
/// and
inline constexpr int kSetEverySamples = 512;
/// so many blocks after each change of it do, and of the six times as many that follow every 8th. A state's
/// set changes whenever the light does, and one that is missed costs no more than a late answer.
template <class Block>
inline constexpr int kSetRepeats = 4;
template <>
inline constexpr int kSetRepeats<StateBlock> = 2;
/// A block is told beside any of so many before it: whichever of them the receiver had last, it is restored.
inline constexpr std::size_t kWindow = 8;
/// Every block of such a number tells its positions without a look at those before it: for a receiver that
/// has missed more.
inline constexpr std::uint32_t kFarEvery = 4;

inline constexpr std::size_t kMaxBlockHead = 4 + 1 + kMaxSetBytes + 96;
inline constexpr std::size_t kMaxCommandBytes = Payload::kCapacity + kMaxBlockHead;
inline constexpr std::size_t kMaxStateBytes = 2 * Payload::kCapacity + kMaxBlockHead;

/// The sending end of one stream. No allocation, lock or throw.
template <class Block>
class HeaderCompressor {
 public:
  /// What is sent for `block`, within `out`; empty: it breaks a bound (a payload too long, an anchor beyond
  /// any robot).
  std::span<const std::uint8_t> compress(const Block& block, std::uint16_t contract,
                                         std::span<std::uint8_t> out) noexcept;

 private:
  using Fields = typename FieldsOf<Block>::Type;

  bool restorable(std::span<const std::uint8_t> told, const Fields& fields, ShortForm form,
                  std::int64_t block_ns) const noexcept;

  std::array<std::uint8_t, kMaxSetBytes> set_{};
  std::size_t set_size_ = 0;
  std::uint8_t tag_ = 0;
  int since_change_ = 0;  ///< blocks
  std::array<Fields, kWindow> sent_{};
  std::size_t count_ = 0;
};

/// The contract that a block's set names; none: this one carries no set.
std::optional<std::uint16_t> contract_of_block(std::span<const std::uint8_t> bytes) noexcept;

/// Who sends: the 12 bytes of its GUID prefix.
using SenderKey = std::array<std::uint8_t, 12>;

/// The receiving end of one topic. No allocation, lock or throw.
template <class Block>
class HeaderDecompressor {
 public:
  /// `block` is unspecified unless the verdict is good.
  Verdict restore(std::span<const std::uint8_t> bytes, const SenderKey& sender, std::uint16_t contract,
                  Block& block) noexcept;

 private:
  using Fields = typename FieldsOf<Block>::Type;
  static constexpr std::size_t kTags = 16;
  static constexpr std::size_t kSenders = 4;  // the one that has been silent longest makes room

  struct Set {
    std::array<std::uint8_t, kMaxSetBytes> bytes{};
    std::size_t size = 0;  ///< 0: none has come
  };
  struct Sender {
    SenderKey key{};
    std::uint64_t heard = 0;  ///< 0: free
    std::array<Set, kTags> sets;
    Fields newest;
  };

  Sender* find(const SenderKey& key) noexcept;
  /// A place for one whose first good block has come.
  Sender& add(const SenderKey& key) noexcept;

  std::array<Sender, kSenders> senders_;
  std::uint64_t turn_ = 0;
};

extern template class HeaderCompressor<CommandBlock>;
extern template class HeaderCompressor<StateBlock>;
extern template class HeaderDecompressor<CommandBlock>;
extern template class HeaderDecompressor<StateBlock>;

}  // namespace telekerf
