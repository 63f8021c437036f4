// SPDX-License-Identifier: Apache-2.0
#include "common/bus/wire_messages.h"

#include <array>
#include <cmath>

namespace telekerf::bus {
namespace {

// Bounds of idl/telekerf.idl; the generated code does not enforce them.
constexpr std::size_t kMaxValues = 256;
constexpr std::size_t kShortText = 32;
constexpr std::size_t kName = 64;
constexpr std::size_t kLongText = 256;

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

bool to_wire(const PreviewMessage& value, std::uint16_t contract, wire::Preview& wire) {
  if (value.jpeg.size() > kMaxPreviewBytes) return false;
  wire.contract(contract);
  wire.contour_id(value.contour_id);
  wire.left_m(value.left_m);
  wire.top_m(value.top_m);
  wire.width_m(value.width_m);
  wire.height_m(value.height_m);
  wire.jpeg() = value.jpeg;
  return true;
}

Verdict from_wire(const wire::Preview& wire, std::uint16_t contract, PreviewMessage& value) {
  if (wire.contract() != contract) return Verdict::kForeignContract;
  if (wire.jpeg().size() > kMaxPreviewBytes || !std::isfinite(wire.left_m()) ||
      !std::isfinite(wire.top_m()) || !(std::isfinite(wire.width_m()) && wire.width_m() > 0.0) ||
      !(std::isfinite(wire.height_m()) && wire.height_m() > 0.0))
    return Verdict::kDamaged;
  value = {wire.contour_id(), wire.left_m(), wire.top_m(), wire.width_m(), wire.height_m(), wire.jpeg()};
  return Verdict::kGood;
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
  if (wire.kind() > static_cast<std::uint8_t>(EventMessage::Kind::kSetStream) || !std::isfinite(wire.value()))
    return Verdict::kDamaged;
  value.epoch = wire.epoch();
  value.kind = static_cast<EventMessage::Kind>(wire.kind());
  value.value = wire.value();
  value.text = wire.text();
  return Verdict::kGood;
}

bool to_wire(const StopMessage& value, std::uint16_t contract, wire::Stop& wire) {
  if (value.source.size() > kName || value.reason.size() > kLongText || value.number == 0) return false;
  wire.contract(contract);
  wire.epoch(value.epoch);
  wire.number(value.number);
  wire.source(value.source);
  wire.in_force(value.set ? 1 : 0);
  wire.obeyed(value.obeyed ? 1 : 0);
  wire.reason(value.reason);
  return true;
}

Verdict from_wire(const wire::Stop& wire, std::uint16_t contract, StopMessage& value) {
  if (wire.contract() != contract) return Verdict::kForeignContract;
  if (wire.number() == 0 || wire.source().size() > kName || wire.reason().size() > kLongText)
    return Verdict::kDamaged;
  value.epoch = wire.epoch();
  value.number = wire.number();
  value.source = wire.source();
  value.set = wire.in_force() != 0;
  value.obeyed = wire.obeyed() != 0;
  value.reason = wire.reason();
  return Verdict::kGood;
}

bool to_wire(const TelemetryMessage& value, std::uint16_t contract, wire::Telemetry& wire) {
  if (value.role.size() > kShortText || value.values.size() > kMaxValues) return false;
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
  if (wire.values().size() > kMaxValues) return Verdict::kDamaged;
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
  const std::size_t written = write_cdr(wire, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(written)};
}

bool read_presence(std::span<const std::uint8_t> bytes, PresenceMessage& presence) {
  std::vector<char> copy(bytes.begin(), bytes.end());  // fastcdr wants mutable bytes
  wire::Presence wire;
  try {
    read_cdr(copy, wire);
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
