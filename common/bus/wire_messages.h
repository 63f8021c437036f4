// SPDX-License-Identifier: Apache-2.0
// Contour, preview, events, telemetry and presence <-> their wire types (generated from idl/telekerf.idl).
// Inside the bus only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/bus/cdr.h"
#include "common/protocol/contour.h"
#include "common/protocol/events.h"
#include "common/protocol/presence.h"
#include "common/protocol/preview.h"
#include "common/protocol/stop.h"
#include "common/protocol/verdict.h"

namespace telekerf::bus {

/// Fill `wire`, checksum included; its vectors are reused, so a stream's block allocates nothing once they
/// have their size. False: the value breaks a bound of the contract (too many points, a text too long).
[[nodiscard]] bool to_wire(const ContourMessage& value, std::uint16_t contract, wire::Contour& wire);
[[nodiscard]] bool to_wire(const PreviewMessage& value, std::uint16_t contract, wire::Preview& wire);
[[nodiscard]] bool to_wire(const EventMessage& value, std::uint16_t contract, wire::Event& wire);
[[nodiscard]] bool to_wire(const StopMessage& value, std::uint16_t contract, wire::Stop& wire);
[[nodiscard]] bool to_wire(const TelemetryMessage& value, std::uint16_t contract, wire::Telemetry& wire);

/// Judge `wire` and fill `value`, which is unspecified unless the verdict is good.
[[nodiscard]] Verdict from_wire(const wire::Contour& wire, std::uint16_t contract, ContourMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Preview& wire, std::uint16_t contract, PreviewMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Event& wire, std::uint16_t contract, EventMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Stop& wire, std::uint16_t contract, StopMessage& value);
[[nodiscard]] Verdict from_wire(const wire::Telemetry& wire, std::uint16_t contract, TelemetryMessage& value);

/// A participant's USER_DATA. An empty vector: a bound is broken.
std::vector<std::uint8_t> presence_bytes(const PresenceMessage& presence);
/// False: not one of ours.
[[nodiscard]] bool read_presence(std::span<const std::uint8_t> bytes, PresenceMessage& presence);

}  // namespace telekerf::bus
