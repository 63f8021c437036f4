// SPDX-License-Identifier: Apache-2.0
#include "master/force_feedback.h"

#include <algorithm>

namespace telekerf::master {
namespace {

constexpr std::size_t kRoom = std::size_t{2} * codec::kMaxBlocks * codec::kMaxBlock;
/// No force for this long: it is not known any more.
constexpr double kSilentS = 0.5;

}  // namespace

ForceFeedback::ForceFeedback() : ring_(kRoom, Vec3::Zero()) {}

Vec3& ForceFeedback::at(std::int64_t index) noexcept {
  return ring_[static_cast<std::size_t>(index) % kRoom];
}

void ForceFeedback::start_over(const StateBlock& state) noexcept {
  if (state.epoch != epoch_) {
    number_ = 0;
    decoder_.reset();
  }
  epoch_ = state.epoch;
  period_ns_ = state.sample_period_ns;
  ticks_per_sample_ = state.ticks_per_sample;
  newest_ = -1;
  cursor_ = -1.0;
}

void ForceFeedback::received(const StateBlock& state) noexcept {
  if (state.force.size == 0 || state.sample_period_ns == 0 || state.ticks_per_sample == 0) return;
  if (state.epoch == epoch_ && state.sequence <= number_) return;
  if (state.epoch != epoch_ || state.sample_period_ns != period_ns_ ||
      state.ticks_per_sample != ticks_per_sample_) {
    start_over(state);
  }
  const auto decoded = decoder_.decode(state.force.view(), {});
  if (!decoded) return;
  number_ = state.sequence;
  silent_s_ = 0.0;
  const codec::DecodedPacket& packet = **decoded;
  block_ = packet.block_size;
  const auto first = static_cast<std::int64_t>(state.first_tick / state.ticks_per_sample);
  const std::int64_t last = first + block_ - 1;
  const std::int64_t oldest = std::max<std::int64_t>(0, first - (packet.blocks - 1) * block_);
  const bool afresh = newest_ < 0 || last < newest_;
  if (afresh || newest_ + 1 < oldest) {  // nothing tells what was before: the last value is held
    const Vec3 held_n = newest_ < 0 ? Vec3(Vec3::Zero()) : at(newest_);
    newest_ = oldest - 1;
    if (newest_ >= 0) at(newest_) = held_n;
    if (afresh) cursor_ = static_cast<double>(first - 1);
  }
  for (; newest_ < last; ++newest_) {
    const std::int64_t back = (last - newest_ - 1) / block_;
    const std::int64_t n = newest_ + 1 - (first - back * block_);
    at(newest_ + 1) =
        packet.blocks_newest_first[static_cast<std::size_t>(back)].samples[static_cast<std::size_t>(n)];
  }
  cursor_ = std::max(cursor_, static_cast<double>(oldest - 1));
}

SlaveForce ForceFeedback::step(double dt_s) noexcept {
  silent_s_ += dt_s;
  if (newest_ < 0) return {};
  const double pace = dt_s * 1e9 / period_ns_;
  const auto newest = static_cast<double>(newest_);
  // A block begins to be given out when it comes.
  const double due = newest - static_cast<double>(block_) + silent_s_ * 1e9 / period_ns_;
  cursor_ = std::min(newest, cursor_ + std::clamp(due - cursor_, pace, 2.0 * pace));
  const auto index = std::max<std::int64_t>(0, static_cast<std::int64_t>(cursor_ + 1e-6));
  return {at(index), static_cast<Tick>(index) * ticks_per_sample_, silent_s_ < kSilentS};
}

}  // namespace telekerf::master
