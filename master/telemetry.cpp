// SPDX-License-Identifier: Apache-2.0
#include "master/telemetry.h"

namespace telekerf::master {

MasterValues master_values(const MasterOutputs& out, double beta, const streaming::ClockEstimate& clocks,
                           double round_trip_s, const StreamChoice& stream) noexcept {
  const GuidePiece& piece = out.active.piece;
  const geometry::CircleOrLine& shape = piece.shape;
  const Vec2 centre = shape.is_line ? shape.point_m : shape.centre_m;
  const Vec2 tangent = shape.tangent(piece.point_m);
  const KinematicState& slave = out.observed.slave;
  return {static_cast<double>(out.mode),
          out.tool_m.x(),
          out.tool_m.y(),
          out.constraint_n,
          out.active.phi_m,
          out.corridor_m,
          out.off_line ? 1.0 : 0.0,
          shape.is_line ? 1.0 : 0.0,
          centre.x(),
          centre.y(),
          shape.is_line ? 0.0 : shape.radius_m,
          tangent.x(),
          tangent.y(),
          piece.arc_m,
          out.active.limit.m_per_s,
          beta,
          slave.position_m.x(),
          slave.position_m.y(),
          slave.position_m.z(),
          slave.velocity_m_per_s.x(),
          slave.velocity_m_per_s.y(),
          slave.velocity_m_per_s.z(),
          out.observed.disturbance_m_per_s2.x(),
          out.observed.disturbance_m_per_s2.y(),
          out.observed.disturbance_m_per_s2.z(),
          out.observed.innovation_m.x(),
          out.observed.innovation_m.y(),
          out.observed.innovation_m.z(),
          out.observed.delay_s,
          out.observed.aligned ? 1.0 : 0.0,
          clocks.offset_s,
          clocks.skew,
          clocks.uncertainty_s,
          out.slave_force.known ? 1.0 : 0.0,
          out.slave_force.force_n.x(),
          out.slave_force.force_n.y(),
          out.slave_force.force_n.z(),
          out.velocity_m_per_s.x(),
          out.velocity_m_per_s.y(),
          out.hand_n.x(),
          out.hand_n.y(),
          round_trip_s,
          static_cast<double>(stream.law),
          static_cast<double>(stream.estimator),
          static_cast<double>(stream.codec),
          static_cast<double>(stream.block),
          static_cast<double>(stream.keep),
          static_cast<double>(stream.redundancy)};
}

// A sequence lock whose data are atomics, so that a torn reading is noticed and never undefined: who has read
// a value of the next writing also sees that writing's odd version.
void Snapshot::store(Tick tick, const MasterValues& values) noexcept {
  const std::uint64_t version = version_.load(std::memory_order_relaxed);
  version_.store(version + 1, std::memory_order_relaxed);
  tick_.store(tick, std::memory_order_release);
  for (std::size_t i = 0; i < values.size(); ++i) values_[i].store(values[i], std::memory_order_release);
  version_.store(version + 2, std::memory_order_release);
}

std::optional<TelemetryMessage> Snapshot::load() const {
  const std::uint64_t before = version_.load(std::memory_order_acquire);
  if (before == 0 || before % 2 != 0) return std::nullopt;
  TelemetryMessage message;
  message.role = "master";
  message.tick = tick_.load(std::memory_order_acquire);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    message.values.emplace_back(kMasterValueNames[i], values_[i].load(std::memory_order_acquire));
  }
  if (version_.load(std::memory_order_relaxed) != before) return std::nullopt;
  return message;
}

}  // namespace telekerf::master
