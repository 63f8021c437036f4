// SPDX-License-Identifier: Apache-2.0
// A stream's block in two parts: the *set* of what mostly stays the same from block to block, and the
// *fields* that each block has anew. Both as bytes, and the fields also in few bytes beside those of another
// block. docs/reference/block.md has the bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/protocol/blocks.h"
#include "common/protocol/bytes.h"

namespace telekerf {

inline constexpr std::size_t kMaxSetBytes = 96;

/// Of both streams. Anchors count their grid (wire_precision.h): positions, then velocities.
struct CommonFields {
  std::uint32_t number = 0;
  std::int64_t sent_ns = 0;
  std::uint32_t echo_number = 0;
  std::int64_t echo_sent_ns = 0;
  std::array<std::int32_t, 6> anchor{};
  bool operator==(const CommonFields&) const = default;
};
struct CommandFields : CommonFields {
  bool operator==(const CommandFields&) const = default;
};
struct StateFields : CommonFields {
  std::uint64_t applied_tick = 0;
  std::uint64_t applied_bitmap = 0;
  std::uint32_t applied_age_ticks = 0;
  std::int32_t playout_ticks = 0;
  std::int64_t echo_received_ns = 0;
  std::uint16_t command_age = 0;    ///< 0.1 ms; 65535: none
  std::uint16_t payload_bytes = 0;  ///< without what the set says of it
  bool operator==(const StateFields&) const = default;
};

template <class Block>
struct FieldsOf;
template <>
struct FieldsOf<CommandBlock> {
  using Type = CommandFields;
};
template <>
struct FieldsOf<StateBlock> {
  using Type = StateFields;
};

/// What a payload begins with, as long as its settings stay the same.
struct PayloadPrefix {
  bool present = false;  ///< false: the payload is shorter, or not sent
  std::array<std::uint8_t, kPayloadFormatBytes> format{};
  std::uint16_t offset = 0;  ///< the payload's number less the block's

  int samples() const noexcept { return present ? (format[2] >> 2) + 1 : 0; }
};

/// What a set says beside the block's own members.
struct SetFrame {
  std::uint16_t contract = 0;
  Tick base = 0;  ///< first tick less number x samples x ticks a sample
  PayloadPrefix payload;
  PayloadPrefix force;
  std::int64_t block_ns = 0;  ///< from one block to the next
};

/// The set of a block. False: there is no room.
bool put_set(ByteWriter& out, const CommandBlock& block, std::uint16_t contract) noexcept;
bool put_set(ByteWriter& out, const StateBlock& block, std::uint16_t contract) noexcept;
/// The members of `block` that a set has. None: no set at all, or one that no sender writes.
std::optional<SetFrame> get_set(ByteReader& in, CommandBlock& block) noexcept;
std::optional<SetFrame> get_set(ByteReader& in, StateBlock& block) noexcept;

/// None: the anchor is not finite, or farther away than any robot is.
std::optional<CommandFields> fields_of(const CommandBlock& block) noexcept;
std::optional<StateFields> fields_of(const StateBlock& block) noexcept;
/// Back, with what `set` has to say to it.
void apply(const CommandFields& fields, const SetFrame& set, CommandBlock& block) noexcept;
void apply(const StateFields& fields, const SetFrame& set, StateBlock& block) noexcept;

/// In whole.
void put_full(ByteWriter& out, const CommandFields& fields) noexcept;
void put_full(ByteWriter& out, const StateFields& fields) noexcept;
void get_full(ByteReader& in, CommandFields& fields) noexcept;
void get_full(ByteReader& in, StateFields& fields) noexcept;

/// How fields stand beside those of an earlier block.
struct ShortForm {
  bool near =
      false;  ///< times and positions in two bytes each, around where that block was going; else in three
  bool all_applied = false;  ///< states: the bitmap is all ones
};
void put_short(ByteWriter& out, const CommandFields& fields, ShortForm form) noexcept;
void put_short(ByteWriter& out, const StateFields& fields, ShortForm form) noexcept;
/// `before`: of a block near this one in number. What was put is what one gets if its values are near, too.
void get_short(ByteReader& in, const CommandFields& before, ShortForm form, std::int64_t block_ns,
               CommandFields& fields) noexcept;
void get_short(ByteReader& in, const StateFields& before, ShortForm form, std::int64_t block_ns,
               StateFields& fields) noexcept;
inline ShortForm wanted(const CommandFields& /*fields*/, bool near) noexcept { return {near, false}; }
inline ShortForm wanted(const StateFields& fields, bool near) noexcept {
  return {near, fields.applied_bitmap == ~std::uint64_t{0}};
}

}  // namespace telekerf
