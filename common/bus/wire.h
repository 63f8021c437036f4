// SPDX-License-Identifier: Apache-2.0
// Domain type <-> wire type (generated from idl/telekerf.idl). Inside the bus only.
#pragma once

#include <telekerf.h>

#include <cstdint>
#include <span>
#include <vector>

#include "common/protocol/messages.h"

namespace telekerf::bus {

/// What became of a sample that arrived.
enum class Verdict {
  kGood,
  kDamaged,          ///< checksum, an unknown enumerator, a broken bound or no number
  kForeignContract,  ///< written under another version of the contract
};

/// Fill `wire`, checksum included; its vectors are reused, so a stream's block allocates nothing once they
/// have their size. False: the value breaks a bound of the contract (too many points, a text too long).
[[nodiscard]] bool to_wire(const CommandBlock& value, std::uint16_t contract, wire::CommandBlock& wire);
[[nodiscard]] bool to_wire(const StateBlock& value, std::uint16_t contract, wire::StateBlock& wire);
[[nodiscard]] bool to_wire(const ContourMessage& value, std::uint16_t contract, wire::Contour& wire);
[[nodiscard]] bool to_wire(const EventMessage& value, std::uint16_t contract, wire::Event& wire);
[[nodiscard]] bool to_wire(const TelemetryMessage& value, std::uint16_t contract, wire::Telemetry& wire);

/// Judge `wire` and fill `value`, which is unspecified unless the verdict is good.
[[nodiscard]] Verdict from_wire(const wire::CommandBlock& wire, std::uint16_t contract, CommandBlock& value);
[[nodiscard]] Verdict from_wire(const wire::StateBlock& wire, std::uint16_t contract, StateBlock& value);
[[nodiscard]] Verdict from_wire(const wire::Contour& wire, std::uint16_t contract, ContourMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Event& wire, std::uint16_t contract, EventMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Telemetry& wire, std::uint16_t contract, TelemetryMessage& value);

/// CRC-32 (IEEE 802.3) over the sample's little-endian plain CDR after the checksum field.
std::uint32_t checksum_of(const wire::CommandBlock& wire);
std::uint32_t checksum_of(const wire::StateBlock& wire);

/// A participant's USER_DATA. An empty vector: a bound is broken.
std::vector<std::uint8_t> presence_bytes(const PresenceMessage& presence);
/// False: not one of ours.
[[nodiscard]] bool read_presence(std::span<const std::uint8_t> bytes, PresenceMessage& presence);

}  // namespace telekerf::bus
