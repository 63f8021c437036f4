// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/state_stream.h"

#include <tuple>

#include "common/protocol/wire_precision.h"

namespace telekerf::slave {

StateStream::StateStream(const StateStreamSettings& settings, std::uint32_t epoch)
    : settings_(settings),
      epoch_(epoch),
      encoder_(settings.positions),
      force_encoder_(settings.forces),
      samples_(codec::kMaxBlock, Vec3::Zero()),
      forces_n_(codec::kMaxBlock, Vec3::Zero()) {
  samples_.resize(static_cast<std::size_t>(settings.positions.block));
  forces_n_.resize(samples_.size());
}

void StateStream::change(const codec::StreamSettings& positions, const codec::StreamSettings& forces) {
  next_.emplace(positions.validated(), forces.validated());
  auto& [next, next_force] = *next_;
  next.sample_period_ns = settings_.positions.sample_period_ns;
  next_force.sample_period_ns = next.sample_period_ns;
  next_force.block = next.block;
}

void StateStream::take_up_changes() noexcept {
  if (!next_) return;
  std::tie(settings_.positions, settings_.forces) = *next_;
  next_.reset();
  encoder_.change(settings_.positions);
  force_encoder_.change(settings_.forces);
  samples_.resize(static_cast<std::size_t>(settings_.positions.block));  // within what was set aside
  forces_n_.resize(samples_.size());
}

std::optional<StateBlock> StateStream::step(std::int64_t now_ns, Tick tick,
                                            const StateSample& sample) noexcept {
  if (tick % static_cast<Tick>(settings_.ticks_per_sample) != 0) return std::nullopt;
  if (filled_ == 0) {
    take_up_changes();
    first_tick_ = tick;
    anchor_ = to_wire_precision({sample.tool_m, sample.velocity_m_per_s});
    laser_mask_ = 0;
  }
  if (sample.laser_on) laser_mask_ |= std::uint64_t{1} << filled_;
  forces_n_[filled_] = sample.force_n;
  samples_[filled_++] = sample.tool_m;
  if (filled_ < samples_.size()) return std::nullopt;
  return finish_block(now_ns);
}

std::optional<StateBlock> StateStream::finish_block(std::int64_t now_ns) noexcept {
  filled_ = 0;
  std::optional<StateBlock> out(std::in_place);
  StateBlock& block = *out;
  block.sequence = ++number_;
  block.epoch = epoch_;
  block.first_tick = first_tick_;
  block.ticks_per_sample = static_cast<std::uint16_t>(settings_.ticks_per_sample);
  block.sample_period_ns =
      static_cast<std::uint32_t>(settings_.control_period_ns * settings_.ticks_per_sample);
  block.anchor = anchor_;
  block.laser_on = (laser_mask_ >> (samples_.size() - 1)) != 0;
  block.sent_ns = now_ns;
  const codec::Trend trend{block.anchor.position_m,
                           block.anchor.velocity_m_per_s * (block.sample_period_ns * 1e-9)};
  const auto bytes = encoder_.encode(samples_, laser_mask_, trend, block.payload.room());
  if (!bytes) return std::nullopt;
  block.payload.size = static_cast<std::uint16_t>(*bytes);
  const auto force_bytes = force_encoder_.encode(forces_n_, 0, {}, block.force.room());
  block.force.size = static_cast<std::uint16_t>(force_bytes.value_or(0));
  ++counters_.states;
  counters_.position_bytes += block.payload.size;
  counters_.force_bytes += block.force.size;
  return out;
}

}  // namespace telekerf::slave
