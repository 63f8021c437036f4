// SPDX-License-Identifier: Apache-2.0
#include "common/bus/wire_blocks.h"

#include <fastcdr/Cdr.h>

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <cmath>
#include <limits>

namespace telekerf::bus {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

template <class Block>
std::uint32_t stream_checksum(const Block& wire) {
  std::array<char, 2 * Payload::kCapacity + 256> bytes{};  // zero: CDR leaves padding octets as they are
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire.serialize(cdr);
  constexpr std::size_t kSkipped = sizeof(wire.checksum());
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data() + kSkipped, cdr.getSerializedDataLength() - kSkipped);
  return crc.checksum();
}

wire::ToolState to_wire(const Anchor& anchor) {
  wire::ToolState wire;
  for (int i = 0; i < 3; ++i) {
    wire.position_m()[i] = static_cast<float>(anchor.position_m[i]);
    wire.velocity_m_per_s()[i] = static_cast<float>(anchor.velocity_m_per_s[i]);
  }
  return wire;
}

Anchor from_wire(const wire::ToolState& wire) {
  Anchor anchor;
  for (int i = 0; i < 3; ++i) {
    anchor.position_m[i] = static_cast<double>(wire.position_m()[i]);
    anchor.velocity_m_per_s[i] = static_cast<double>(wire.velocity_m_per_s()[i]);
  }
  return anchor;
}

void to_wire(const Payload& payload, std::vector<std::uint8_t>& wire) {
  wire.reserve(Payload::kCapacity);
  wire.assign(payload.bytes.begin(), payload.bytes.begin() + payload.size);
}

void from_wire(const std::vector<std::uint8_t>& wire, Payload& payload) {
  payload.size = static_cast<std::uint16_t>(wire.size());
  std::copy(wire.begin(), wire.end(), payload.bytes.begin());
}

/// The fields that the blocks of both streams have, payload included.
template <class Block, class Wire>
void common_to_wire(const Block& value, Wire& wire) {
  wire.number(value.sequence);
  wire.epoch(value.epoch);
  wire.first_tick(value.first_tick);
  wire.sent_ns(value.sent_ns);
  wire.sample_period_ns(value.sample_period_ns);
  wire.contour_id(value.contour_id);
  wire.beta(static_cast<float>(value.beta));
  wire.anchor(to_wire(value.anchor));
  wire.ticks_per_sample(value.ticks_per_sample);
  to_wire(value.payload, wire.payload());
}
template <class Wire, class Block>
void common_from_wire(const Wire& wire, Block& value) {
  value.sequence = wire.number();
  value.epoch = wire.epoch();
  value.first_tick = wire.first_tick();
  value.sent_ns = wire.sent_ns();
  value.sample_period_ns = wire.sample_period_ns();
  value.contour_id = wire.contour_id();
  value.beta = static_cast<double>(wire.beta());
  value.anchor = from_wire(wire.anchor());
  value.ticks_per_sample = wire.ticks_per_sample();
  from_wire(wire.payload(), value.payload);
}

constexpr std::uint32_t kNoAge = std::numeric_limits<std::uint32_t>::max();

std::uint32_t age_to_wire(double age_s) {
  if (!(age_s >= 0.0)) return kNoAge;
  return static_cast<std::uint32_t>(std::min(std::round(age_s * 1e6), static_cast<double>(kNoAge - 1)));
}

bool payloads_fit(const wire::CommandBlock& wire) { return wire.payload().size() <= Payload::kCapacity; }
bool payloads_fit(const wire::StateBlock& wire) {
  return wire.payload().size() <= Payload::kCapacity && wire.force().size() <= Payload::kCapacity;
}

/// What both streams ask of a block before anything in it is used.
template <class Block>
Verdict judged(const Block& wire, std::uint16_t contract) {
  if (!payloads_fit(wire) || wire.checksum() != stream_checksum(wire)) return Verdict::kDamaged;
  if (wire.contract() != contract) return Verdict::kForeignContract;
  bool finite = std::isfinite(wire.beta());
  for (const float x : wire.anchor().position_m()) finite = finite && std::isfinite(x);
  for (const float v : wire.anchor().velocity_m_per_s()) finite = finite && std::isfinite(v);
  return finite ? Verdict::kGood : Verdict::kDamaged;
}

}  // namespace

std::uint32_t checksum_of(const wire::CommandBlock& wire) { return stream_checksum(wire); }
std::uint32_t checksum_of(const wire::StateBlock& wire) { return stream_checksum(wire); }

bool to_wire(const CommandBlock& value, std::uint16_t contract, wire::CommandBlock& wire) {
  if (value.payload.size > Payload::kCapacity) return false;
  wire.contract(contract);
  wire.law(static_cast<std::uint8_t>(value.law));
  wire.engaged(static_cast<std::uint8_t>((value.engaged_before << 1U) | (value.engaged ? 1U : 0U)));
  wire.engage(value.engage);
  wire.stop(value.stop);
  wire.echo_number(value.echo_sequence);
  wire.echo_sent_ns(value.echo_sent_ns);
  common_to_wire(value, wire);
  wire.checksum(stream_checksum(wire));
  return true;
}

Verdict from_wire(const wire::CommandBlock& wire, std::uint16_t contract, CommandBlock& value) {
  if (const Verdict verdict = judged(wire, contract); verdict != Verdict::kGood) return verdict;
  if (wire.law() > static_cast<std::uint8_t>(Law::kRemoteAcceleration)) return Verdict::kDamaged;
  value.law = static_cast<Law>(wire.law());
  value.engaged = (wire.engaged() & 1U) != 0;
  value.engaged_before = static_cast<std::uint8_t>(wire.engaged() >> 1U);
  value.engage = wire.engage();
  value.stop = wire.stop();
  value.echo_sequence = wire.echo_number();
  value.echo_sent_ns = wire.echo_sent_ns();
  common_from_wire(wire, value);
  return Verdict::kGood;
}

bool to_wire(const StateBlock& value, std::uint16_t contract, wire::StateBlock& wire) {
  if (value.payload.size > Payload::kCapacity || value.force.size > Payload::kCapacity) return false;
  wire.contract(contract);
  wire.interlock(static_cast<std::uint8_t>(value.interlock));
  wire.laser_on(value.laser_on ? 1 : 0);
  wire.master_epoch(value.master_epoch);
  wire.applied_tick(value.applied_tick);
  wire.applied_bitmap(value.applied_bitmap);
  wire.applied_age_ticks(value.applied_age_ticks);
  wire.playout_ticks(value.playout_ticks);
  wire.echo_number(value.echo_sequence);
  wire.echo_sent_ns(value.echo_sent_ns);
  wire.echo_received_ns(value.echo_received_ns);
  wire.mode(static_cast<std::uint8_t>(value.mode));
  wire.reason(static_cast<std::uint8_t>(value.reason));
  wire.engage(value.engage);
  wire.stop(value.stop);
  wire.stop_tick(value.stop_tick);
  wire.guards(value.guards);
  wire.command_age_us(age_to_wire(value.command_age_s));
  to_wire(value.force, wire.force());
  common_to_wire(value, wire);
  wire.checksum(stream_checksum(wire));
  return true;
}

Verdict from_wire(const wire::StateBlock& wire, std::uint16_t contract, StateBlock& value) {
  if (const Verdict verdict = judged(wire, contract); verdict != Verdict::kGood) return verdict;
  if (wire.interlock() > static_cast<std::uint8_t>(kLastInterlock) ||
      wire.mode() > static_cast<std::uint8_t>(SlaveMode::kStopped) ||
      wire.reason() > static_cast<std::uint8_t>(HoldReason::kStopped))
    return Verdict::kDamaged;
  value.interlock = static_cast<Interlock>(wire.interlock());
  value.laser_on = wire.laser_on() != 0;
  value.master_epoch = wire.master_epoch();
  value.applied_tick = wire.applied_tick();
  value.applied_bitmap = wire.applied_bitmap();
  value.applied_age_ticks = wire.applied_age_ticks();
  value.playout_ticks = wire.playout_ticks();
  value.echo_sequence = wire.echo_number();
  value.echo_sent_ns = wire.echo_sent_ns();
  value.echo_received_ns = wire.echo_received_ns();
  value.mode = static_cast<SlaveMode>(wire.mode());
  value.reason = static_cast<HoldReason>(wire.reason());
  value.engage = wire.engage();
  value.stop = wire.stop();
  value.stop_tick = wire.stop_tick();
  value.guards = wire.guards();
  value.command_age_s = wire.command_age_us() == kNoAge ? -1.0 : wire.command_age_us() * 1e-6;
  from_wire(wire.force(), value.force);
  common_from_wire(wire, value);
  return Verdict::kGood;
}

}  // namespace telekerf::bus
