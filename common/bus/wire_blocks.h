// SPDX-License-Identifier: Apache-2.0
// The streams' blocks <-> their wire types (generated from idl/telekerf.idl). Inside the bus only.
#pragma once

#include <telekerf.h>

#include <cstdint>

#include "common/bus/verdict.h"
#include "common/protocol/blocks.h"

namespace telekerf::bus {

/// Fill `wire`, checksum included; its vectors are reused, so a stream's block allocates nothing once they
/// have their size. False: the value breaks a bound of the contract (too many points, a text too long).
[[nodiscard]] bool to_wire(const CommandBlock& value, std::uint16_t contract, wire::CommandBlock& wire);
[[nodiscard]] bool to_wire(const StateBlock& value, std::uint16_t contract, wire::StateBlock& wire);

/// Judge `wire` and fill `value`, which is unspecified unless the verdict is good.
[[nodiscard]] Verdict from_wire(const wire::CommandBlock& wire, std::uint16_t contract, CommandBlock& value);
[[nodiscard]] Verdict from_wire(const wire::StateBlock& wire, std::uint16_t contract, StateBlock& value);

/// CRC-32 (IEEE 802.3) over the sample's little-endian plain CDR after the checksum field.
std::uint32_t checksum_of(const wire::CommandBlock& wire);
std::uint32_t checksum_of(const wire::StateBlock& wire);

}  // namespace telekerf::bus
