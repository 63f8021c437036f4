// SPDX-License-Identifier: Apache-2.0
// Domain types <-> what the middleware carries, with what a stream's ends remember of earlier blocks. Inside
// the bus only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/cdr.h"
#include "common/bus/wire_messages.h"
#include "common/protocol/header_compression.h"

namespace telekerf::bus {

/// The contract under which it was written, where that can be seen.
template <class Wire>
std::optional<std::uint16_t> contract_of(const Wire& wire) {
  if constexpr (requires { wire.contract(); }) {
    return wire.contract();
  } else {
    return contract_of_block(wire.octets());
  }
}

/// The sending end. False: the value breaks a bound of the contract (too many points, a text too long).
template <class T>
class ToWire {
 public:
  template <class Wire>
  bool operator()(const T& value, std::uint16_t contract, Wire& wire) {
    return to_wire(value, contract, wire);
  }
};
/// The receiving end: judges `wire` and fills `value`, which is unspecified unless the verdict is good.
template <class T>
class FromWire {
 public:
  template <class Wire>
  Verdict operator()(const Wire& wire, const SenderKey& /*sender*/, std::uint16_t contract, T& value) {
    return from_wire(wire, contract, value);
  }
};

/// `wire`'s vector is reused, so a stream's block allocates nothing once that has its size.
template <class Block, std::size_t kMost>
class BlockToWire {
 public:
  template <class Wire>
  bool operator()(const Block& block, std::uint16_t contract, Wire& wire) {
    const auto bytes = compressor_.compress(block, contract, room_);
    wire.octets().reserve(kMost);
    wire.octets().assign(bytes.begin(), bytes.end());
    return !bytes.empty();
  }

 private:
  HeaderCompressor<Block> compressor_;
  std::array<std::uint8_t, kMost> room_;
};
template <class Block>
class BlockFromWire {
 public:
  template <class Wire>
  Verdict operator()(const Wire& wire, const SenderKey& sender, std::uint16_t contract, Block& block) {
    return decompressor_.restore(wire.octets(), sender, contract, block);
  }

 private:
  HeaderDecompressor<Block> decompressor_;
};

template <>
class ToWire<CommandBlock> : public BlockToWire<CommandBlock, kMaxCommandBytes> {};
template <>
class ToWire<StateBlock> : public BlockToWire<StateBlock, kMaxStateBytes> {};
template <>
class FromWire<CommandBlock> : public BlockFromWire<CommandBlock> {};
template <>
class FromWire<StateBlock> : public BlockFromWire<StateBlock> {};

}  // namespace telekerf::bus
