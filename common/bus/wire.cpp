// SPDX-License-Identifier: Apache-2.0
#include "common/bus/wire.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>

#include <array>
#include <boost/crc.hpp>
#include <cmath>
#include <span>

namespace telekerf::bus {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// Bounds of idl/telekerf.idl; the generated code does not enforce them.

constexpr std::size_t kMostValues = 256;
constexpr std::size_t kShortText = 32;
constexpr std::size_t kName = 64;
constexpr std::size_t kLongText = 256;

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
  to_wire(value.force, wire.force());
  common_to_wire(value, wire);
  wire.checksum(stream_checksum(wire));
  return true;
}

Verdict from_wire(const wire::StateBlock& wire, std::uint16_t contract, StateBlock& value) {
  if (const Verdict verdict = judged(wire, contract); verdict != Verdict::kGood) return verdict;
  if (wire.interlock() > static_cast<std::uint8_t>(Interlock::kStopped)) return Verdict::kDamaged;
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
  from_wire(wire.force(), value.force);
  common_from_wire(wire, value);
  return Verdict::kGood;
}

namespace {

void append(const std::vector<Vec2>& points_m, std::vector<wire::Point>& wire) {
  for (const Vec2& point_m : points_m) {
    wire.emplace_back();
    wire.back().x_m(point_m.x());
    wire.back().y_m(point_m.y());
  }
}

/// False if a coordinate is not finite.
bool append(std::span<const wire::Point> wire, std::vector<Vec2>& points_m) {
  points_m.reserve(points_m.size() + wire.size());
  for (const wire::Point& point : wire) {
    if (!std::isfinite(point.x_m()) || !std::isfinite(point.y_m())) return false;
    points_m.emplace_back(point.x_m(), point.y_m());
  }
  return true;
}

}  // namespace

bool to_wire(const ContourMessage& value, std::uint16_t contract, wire::Contour& wire) {
  std::size_t further = 0;
  for (const ContourLine& line : value.further) further += line.points_m.size();
  if (value.further.size() > kMaxContourLines || further > kMaxContourPoints ||
      value.points_m.size() > kMaxContourPoints || value.source.size() > kLongText ||
      value.mode.size() > kShortText)
    return false;
  wire.contract(contract);
  wire.id(value.id);
  wire.closed(value.closed ? 1 : 0);
  wire.source(value.source);
  wire.mode(value.mode);
  wire.metres_per_pixel(value.metres_per_pixel);
  wire.deviation_m(value.deviation_m);
  wire.points().clear();
  append(value.points_m, wire.points());
  wire.further().clear();
  wire.further_points().clear();
  for (const ContourLine& line : value.further) {
    wire.further().emplace_back();
    wire.further().back().closed(line.closed ? 1 : 0);
    wire.further().back().points(static_cast<std::uint32_t>(line.points_m.size()));
    append(line.points_m, wire.further_points());
  }
  return true;
}

Verdict from_wire(const wire::Contour& wire, std::uint16_t contract, ContourMessage& value) {
  if (wire.contract() != contract) return Verdict::kForeignContract;
  if (wire.points().size() > kMaxContourPoints || wire.further().size() > kMaxContourLines ||
      wire.further_points().size() > kMaxContourPoints)
    return Verdict::kDamaged;
  if (!std::isfinite(wire.metres_per_pixel()) || !std::isfinite(wire.deviation_m())) return Verdict::kDamaged;
  value.id = wire.id();
  value.closed = wire.closed() != 0;
  value.source = wire.source();
  value.mode = wire.mode();
  value.metres_per_pixel = wire.metres_per_pixel();
  value.deviation_m = wire.deviation_m();
  value.points_m.clear();
  if (!append(wire.points(), value.points_m)) return Verdict::kDamaged;
  value.further.clear();
  std::span<const wire::Point> left(wire.further_points());
  for (const wire::FurtherLine& line : wire.further()) {
    value.further.push_back({line.closed() != 0, {}});
    if (line.points() > left.size() || !append(left.first(line.points()), value.further.back().points_m))
      return Verdict::kDamaged;
    left = left.subspan(line.points());
  }
  return left.empty() ? Verdict::kGood : Verdict::kDamaged;
}

bool to_wire(const EventMessage& value, std::uint16_t contract, wire::Event& wire) {
  if (value.text.size() > kLongText) return false;
  wire.contract(contract);
  wire.epoch(value.epoch);
  wire.kind(static_cast<std::uint8_t>(value.kind));
  wire.value(value.value);
  wire.text(value.text);
  return true;
}

Verdict from_wire(const wire::Event& wire, std::uint16_t contract, EventMessage& value) {
  if (wire.contract() != contract) return Verdict::kForeignContract;
  if (wire.kind() > static_cast<std::uint8_t>(EventMessage::Kind::kSetNetem) || !std::isfinite(wire.value()))
    return Verdict::kDamaged;
  value.epoch = wire.epoch();
  value.kind = static_cast<EventMessage::Kind>(wire.kind());
  value.value = wire.value();
  value.text = wire.text();
  return Verdict::kGood;
}

bool to_wire(const TelemetryMessage& value, std::uint16_t contract, wire::Telemetry& wire) {
  if (value.role.size() > kShortText || value.values.size() > kMostValues) return false;
  wire.contract(contract);
  wire.role(value.role);
  wire.tick(value.tick);
  wire.values().resize(value.values.size());
  for (std::size_t i = 0; i < value.values.size(); ++i) {
    if (value.values[i].first.size() > kName) return false;
    wire.values()[i].name(value.values[i].first);
    wire.values()[i].value(value.values[i].second);
  }
  return true;
}

Verdict from_wire(const wire::Telemetry& wire, std::uint16_t contract, TelemetryMessage& value) {
  if (wire.contract() != contract) return Verdict::kForeignContract;
  if (wire.values().size() > kMostValues) return Verdict::kDamaged;
  value.role = wire.role();
  value.tick = wire.tick();
  value.values.clear();
  for (const wire::NamedNumber& entry : wire.values()) value.values.emplace_back(entry.name(), entry.value());
  return Verdict::kGood;
}

std::vector<std::uint8_t> presence_bytes(const PresenceMessage& presence) {
  if (presence.cell.size() > kName || presence.role.size() > kShortText || presence.name.size() > kName ||
      presence.version.size() > kShortText)
    return {};
  wire::Presence wire;
  wire.contract(presence.contract);
  wire.cell(presence.cell);
  wire.role(presence.role);
  wire.name(presence.name);
  wire.epoch(presence.epoch);
  wire.joined(presence.joined ? 1 : 0);
  wire.version(presence.version);
  std::array<char, 512> bytes{};
  FastBuffer buffer(bytes.data(), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire.serialize(cdr);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(cdr.getSerializedDataLength())};
}

bool read_presence(std::span<const std::uint8_t> bytes, PresenceMessage& presence) {
  std::vector<char> copy(bytes.begin(), bytes.end());  // fastcdr wants mutable bytes
  FastBuffer buffer(copy.data(), copy.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::CORBA_CDR);
  wire::Presence wire;
  try {
    wire.deserialize(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
  presence.contract = wire.contract();
  presence.cell = wire.cell();
  presence.role = wire.role();
  presence.name = wire.name();
  presence.epoch = wire.epoch();
  presence.joined = wire.joined() != 0;
  presence.version = wire.version();
  return true;
}

}  // namespace telekerf::bus
