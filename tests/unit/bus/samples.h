// SPDX-License-Identifier: Apache-2.0
// Seeded random messages, every field different, and their comparison.
#pragma once

#include <random>

#include "common/protocol/messages.h"
#include "common/protocol/wire_precision.h"

namespace telekerf::samples {

using Random = std::mt19937_64;

inline double number(Random& random) { return std::uniform_real_distribution<double>(-0.1, 0.1)(random); }
inline Anchor anchor(Random& random) {
  Anchor anchor;
  for (int i = 0; i < 3; ++i) {
    anchor.position_m[i] = number(random);
    anchor.velocity_m_per_s[i] = number(random);
  }
  return to_wire_precision(anchor);
}
inline void fill(Random& random, Payload& payload, std::size_t size) {
  payload.size = static_cast<std::uint16_t>(size);
  for (std::size_t i = 0; i < size; ++i) payload.bytes[i] = static_cast<std::uint8_t>(random());
}

inline CommandBlock command(Random& random, std::size_t payload_bytes) {
  CommandBlock block;
  block.sequence = static_cast<std::uint32_t>(random());
  block.epoch = static_cast<std::uint32_t>(random());
  block.first_tick = random();
  block.sample_period_ns = static_cast<std::uint32_t>(random());
  block.ticks_per_sample = static_cast<std::uint16_t>(random());
  block.contour_id = static_cast<std::uint32_t>(random());
  block.beta = to_wire_precision(0.3 + number(random));
  block.law = static_cast<Law>(random() % 3);
  block.engaged = random() % 2 == 0;
  block.engaged_before = static_cast<std::uint8_t>(random() % 128);
  block.anchor = anchor(random);
  block.sent_ns = static_cast<std::int64_t>(random());
  block.engage = static_cast<std::uint32_t>(random());
  block.stop = static_cast<std::uint32_t>(random());
  block.echo_sequence = static_cast<std::uint32_t>(random());
  block.echo_sent_ns = static_cast<std::int64_t>(random());
  fill(random, block.payload, payload_bytes);
  return block;
}

inline StateBlock state(Random& random, std::size_t payload_bytes) {
  StateBlock block;
  block.sequence = static_cast<std::uint32_t>(random());
  block.epoch = static_cast<std::uint32_t>(random());
  block.master_epoch = static_cast<std::uint32_t>(random());
  block.first_tick = random();
  block.sample_period_ns = static_cast<std::uint32_t>(random());
  block.ticks_per_sample = static_cast<std::uint16_t>(random());
  block.contour_id = static_cast<std::uint32_t>(random());
  block.beta = to_wire_precision(0.3 + number(random));
  block.anchor = anchor(random);
  block.interlock = static_cast<Interlock>(random() % 8);
  block.laser_on = random() % 2 == 0;
  block.applied_tick = random();
  block.applied_age_ticks = static_cast<std::uint32_t>(random());
  block.applied_bitmap = random();
  block.playout_ticks = static_cast<std::int32_t>(random());
  block.echo_sequence = static_cast<std::uint32_t>(random());
  block.echo_sent_ns = static_cast<std::int64_t>(random());
  block.echo_received_ns = static_cast<std::int64_t>(random());
  block.sent_ns = static_cast<std::int64_t>(random());
  block.mode = static_cast<SlaveMode>(random() % 4);
  block.reason = static_cast<HoldReason>(random() % 9);
  block.engage = static_cast<std::uint32_t>(random());
  block.stop = static_cast<std::uint32_t>(random());
  block.stop_tick = random();
  block.guards = static_cast<std::uint32_t>(random());
  block.command_age_s = random() % 3 == 0 ? -1.0 : static_cast<double>(random() % 60000) / 1e4;
  fill(random, block.payload, payload_bytes);
  fill(random, block.force, payload_bytes / 2);
  return block;
}

inline ContourMessage contour(Random& random, std::size_t points) {
  ContourMessage message;
  message.id = static_cast<std::uint32_t>(random());
  message.closed = random() % 2 == 0;
  message.source = "leaf.png";
  message.mode = "outline";
  message.metres_per_pixel = number(random);
  message.deviation_m = number(random);
  message.points_m.resize(points);
  for (Vec2& point : message.points_m) point = {number(random), number(random)};
  for (const std::size_t size : {std::size_t{0}, points / 3, points / 2}) {
    message.further.push_back({random() % 2 == 0, std::vector<Vec2>(size)});
    for (Vec2& point : message.further.back().points_m) point = {number(random), number(random)};
  }
  return message;
}

inline bool same(const Anchor& a, const Anchor& b) {
  return a.position_m == b.position_m && a.velocity_m_per_s == b.velocity_m_per_s;
}
inline bool same(const Payload& a, const Payload& b) {
  return a.size == b.size && std::equal(a.view().begin(), a.view().end(), b.view().begin());
}
inline bool same(const CommandBlock& a, const CommandBlock& b) {
  return a.sequence == b.sequence && a.epoch == b.epoch && a.first_tick == b.first_tick &&
         a.sample_period_ns == b.sample_period_ns && a.ticks_per_sample == b.ticks_per_sample &&
         a.contour_id == b.contour_id && a.beta == b.beta && a.law == b.law && a.engaged == b.engaged &&
         a.engaged_before == b.engaged_before && same(a.anchor, b.anchor) && a.sent_ns == b.sent_ns &&
         a.engage == b.engage && a.stop == b.stop && a.echo_sequence == b.echo_sequence &&
         a.echo_sent_ns == b.echo_sent_ns && same(a.payload, b.payload);
}
inline bool same(const StateBlock& a, const StateBlock& b) {
  return a.sequence == b.sequence && a.epoch == b.epoch && a.master_epoch == b.master_epoch &&
         a.first_tick == b.first_tick && a.sample_period_ns == b.sample_period_ns &&
         a.ticks_per_sample == b.ticks_per_sample && a.contour_id == b.contour_id && a.beta == b.beta &&
         same(a.anchor, b.anchor) && a.interlock == b.interlock && a.laser_on == b.laser_on &&
         a.applied_tick == b.applied_tick && a.applied_age_ticks == b.applied_age_ticks &&
         a.applied_bitmap == b.applied_bitmap && a.playout_ticks == b.playout_ticks &&
         a.echo_sequence == b.echo_sequence && a.echo_sent_ns == b.echo_sent_ns &&
         a.echo_received_ns == b.echo_received_ns && a.sent_ns == b.sent_ns && a.mode == b.mode &&
         a.reason == b.reason && a.engage == b.engage && a.stop == b.stop && a.stop_tick == b.stop_tick &&
         a.guards == b.guards && a.command_age_s == b.command_age_s && same(a.payload, b.payload) &&
         same(a.force, b.force);
}
inline bool same(const ContourLine& a, const ContourLine& b) {
  return a.closed == b.closed && a.points_m == b.points_m;
}
inline bool same(const ContourMessage& a, const ContourMessage& b) {
  return a.id == b.id && a.closed == b.closed && a.source == b.source && a.mode == b.mode &&
         a.metres_per_pixel == b.metres_per_pixel && a.deviation_m == b.deviation_m &&
         a.points_m == b.points_m &&
         std::equal(a.further.begin(), a.further.end(), b.further.begin(), b.further.end(),
                    [](const ContourLine& x, const ContourLine& y) { return same(x, y); });
}
inline bool same(const EventMessage& a, const EventMessage& b) {
  return a.epoch == b.epoch && a.kind == b.kind && a.value == b.value && a.text == b.text;
}
inline bool same(const TelemetryMessage& a, const TelemetryMessage& b) {
  return a.role == b.role && a.tick == b.tick && a.values == b.values;
}

}  // namespace telekerf::samples
