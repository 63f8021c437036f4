// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/attackers.h"

#include <algorithm>

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kTape_ns = 4'000'000'000;
/// Added to the epochs under which a tape is played again.
constexpr std::uint32_t kForeignEpoch = 5000;
/// How far ahead of the true stream a tape is renumbered.
constexpr Tick kAhead = 64;
/// Half of all numbers: what is as far ahead as that counts as behind.
constexpr std::uint32_t kFarthest = 0x80000000U;

}  // namespace

void Forger::step(std::int64_t now_ns, const FaultWindow& window, BirthRegister& births,
                  std::vector<Datagram>& out) {
  if (!seen_ || now_ns < next_ns_) return;
  if (window.from_s != window_from_s_) {
    window_from_s_ = window.from_s;
    spot_ = {.position_m = seen_->anchor.position_m};
  }
  next_ns_ = now_ns + std::int64_t{block_samples_} * seen_->sample_period_ns;
  forged_ = seen_->sequence - forged_ < kFarthest ? seen_->sequence + 1 : forged_ + 1;
  Datagram datagram{.block = *seen_, .born_ns = now_ns};
  CommandBlock& block = datagram.block;
  block.sequence = window.word % 3 == 0   ? 0xFFFFFFFFU
                   : window.word % 3 == 1 ? seen_->sequence + kFarthest - 1
                                          : forged_;
  block.first_tick += static_cast<Tick>(block_samples_) * block.ticks_per_sample;
  block.engaged = true;
  block.engaged_before = 0;
  block.button = ~std::uint64_t{0};
  block.anchor = spot_;
  const std::vector<Vec3> still(static_cast<std::size_t>(block_samples_), Vec3::Zero());
  const auto bytes = encoder_.encode(still, block.button, {}, block.payload.room());
  if (!bytes) return;
  block.payload.size = static_cast<std::uint16_t>(*bytes);
  for (int i = 0; i < block_samples_ * block.ticks_per_sample; ++i)
    births.made(block.epoch, block.first_tick + static_cast<Tick>(i), now_ns);
  seen_->first_tick = block.first_tick;
  out.push_back(datagram);
}

void Replayer::saw(std::int64_t now_ns, const CommandBlock& block) {
  tape_.push_back({now_ns, block});
  while (now_ns - tape_.front().at_ns > kTape_ns) tape_.pop_front();
}

void Replayer::step(std::int64_t now_ns, const FaultWindow& window, BirthRegister& births,
                    std::vector<Datagram>& out) {
  if (window.from_s != window_from_s_) {
    window_from_s_ = window.from_s;
    played_.assign(tape_.begin(), tape_.end());
    began_ns_ = now_ns;
    next_ = 0;
  }
  if (played_.empty()) return;
  const std::uint64_t how = window.word % 3;  // as it was, under another epoch, renumbered
  while (next_ < played_.size() && played_[next_].at_ns - played_.front().at_ns <= now_ns - began_ns_) {
    const Recorded& recorded = played_[next_++];
    Datagram datagram{.block = recorded.block, .born_ns = recorded.at_ns};
    CommandBlock& block = datagram.block;
    const Tick first = block.first_tick;
    if (how == 1) block.epoch += kForeignEpoch;
    if (how == 2) {
      block.sequence = played_.back().block.sequence + static_cast<std::uint32_t>(next_);
      block.first_tick += played_.back().block.first_tick - played_.front().block.first_tick + kAhead;
    }
    if (how == 1) {
      for (Tick i = 0; i < kAhead; ++i) {
        if (const auto born = births.of(recorded.block.epoch, first + i))
          births.made(block.epoch, first + i, *born);
      }
    }
    out.push_back(datagram);
  }
}

}  // namespace telekerf::experiments
