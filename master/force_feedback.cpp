// SPDX-License-Identifier: Apache-2.0
#include "master/force_feedback.h"

#include <algorithm>

namespace telekerf::master {
namespace {

constexpr std::size_t kRoom = std::size_t{2} * codec::kMaxBlocks * codec::kMaxBlock;
/// No force for this long: it is not known any more.
constexpr double kSilent_s = 0.5;

}  // namespace

ForceFeedback::ForceFeedback() : ring_(kRoom, Vec3::Zero()) {}

Vec3& ForceFeedback::at(std::int64_t index) noexcept {
  return ring_[static_cast<std::size_t>(index) % kRoom];
}

void ForceFeedback::received(const streaming::Feedback& feedback, const StateHeader& header) noexcept {
  if (feedback.begins) {
    newest_ = -1;
    cursor_ = -1.0;
  }
  if (!feedback.force_n) return;
  const streaming::PacketSamples& samples = *feedback.force_n;
  period_ns_ = header.sample_period_ns;
  ticks_per_sample_ = header.ticks_per_sample;
  silent_s_ = 0.0;
  block_ = samples.size();
  const std::int64_t last = samples.last();
  const std::int64_t oldest = std::max<std::int64_t>(0, samples.oldest());
  const bool afresh = newest_ < 0 || last < newest_;
  if (afresh || newest_ + 1 < oldest) {  // nothing tells what was before: the last value is held
    const Vec3 held_n = newest_ < 0 ? Vec3(Vec3::Zero()) : at(newest_);
    newest_ = oldest - 1;
    if (newest_ >= 0) at(newest_) = held_n;
    if (afresh) cursor_ = static_cast<double>(samples.first() - 1);
  }
  for (; newest_ < last; ++newest_) at(newest_ + 1) = samples.at(newest_ + 1);
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
  return {at(index), static_cast<Tick>(index) * ticks_per_sample_, silent_s_ < kSilent_s};
}

}  // namespace telekerf::master
