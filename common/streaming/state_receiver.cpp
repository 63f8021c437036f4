// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/state_receiver.h"

#include <algorithm>
#include <limits>

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kNothingLate = std::numeric_limits<std::int64_t>::max();

/// Velocity at sample n of a block: differences, one-sided of second order at the ends.
Vec3 velocity_at(std::span<const Vec3> p, std::size_t n, double period_s, const Vec3& otherwise) {
  const std::size_t last = p.size() - 1;
  if (last < 2) return otherwise;
  if (n == 0) return (-1.5 * p[0] + 2.0 * p[1] - 0.5 * p[2]) / period_s;
  if (n == last) return (1.5 * p[last] - 2.0 * p[last - 1] + 0.5 * p[last - 2]) / period_s;
  return (p[n + 1] - p[n - 1]) / (2.0 * period_s);
}

}  // namespace

StateReceiver::StateReceiver(double silence_s, std::uint32_t epoch, int ticks_per_sample)
    : epoch_(epoch), ticks_per_sample_(ticks_per_sample), stream_(silence_s) {
  samples_.reserve(std::size_t{codec::kMaxBlocks} * codec::kMaxBlock);
}

const Feedback& StateReceiver::receive(const Received<StateBlock>& received) noexcept {
  feedback_ = {};
  const bool ours = received.value.master_epoch == epoch_;
  const Arrival arrival = stream_.receive(received, kNothingLate, {}, ours);
  feedback_.kind = arrival.kind;
  feedback_.number = received.value.sequence;
  if (arrival.kind != Arrival::Kind::kNew) return feedback_;
  const StateBlock& block = received.value;
  feedback_.begins = arrival.begins;
  feedback_.ours = ours;
  if (arrival.begins) newest_ = -1;
  take_samples({*arrival.packet, arrival.first});
  if (block.force.size == 0) return feedback_;
  if (block.epoch != force_epoch_) force_decoder_.reset();
  force_epoch_ = block.epoch;
  if (const auto force = force_decoder_.decode(block.force.view(), {})) {
    feedback_.force_n.emplace(**force, arrival.first);
  }
  return feedback_;
}

void StateReceiver::take_samples(const PacketSamples& positions) noexcept {
  const double period_s = header().sample_period_ns * 1e-9;
  const Acknowledgement acknowledgement = read(header(), ticks_per_sample_);
  samples_.clear();
  for (std::int64_t time = std::max(positions.oldest(), newest_ + 1); time <= positions.last(); ++time) {
    const AppliedCommand command = applied_at(acknowledgement, positions.last() - time);
    samples_.push_back({.index = command.index,
                        .time = time,
                        .applied = feedback_.ours && command.applied,
                        .position_m = positions.at(time),
                        .velocity_m_per_s = velocity_at(positions.block(time), positions.offset(time),
                                                        period_s, header().anchor.velocity_m_per_s)});
  }
  newest_ = std::max(newest_, positions.last());
  feedback_.samples = samples_;
}

}  // namespace telekerf::streaming
