// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/redundancy_control.h"

#include <algorithm>
#include <utility>

namespace telekerf::streaming {
namespace {

/// Blocks by which one may be late and still come.
constexpr int kPatience = 32;

}  // namespace

void GapFinder::received(std::span<const SlaveSample> samples, std::int64_t engaged_from) noexcept {
  for (const SlaveSample& sample : samples) {
    if (sample.time != time_ + 1) unapplied_ = 0;  // what was between is not known
    time_ = sample.time;
    const bool led = index_ >= engaged_from;
    // Over a concealed stretch the last acknowledgement stands: nothing new was applied there.
    if (!sample.applied || (led && sample.index <= index_)) {
      unapplied_ = led ? unapplied_ + 1 : 0;
      continue;
    }
    // A slave that stood and went on where it had been has lost nothing.
    const auto missing = static_cast<int>(std::min<std::int64_t>(unapplied_, sample.index - index_ - 1));
    if (led && missing > longest_.samples) longest_ = {index_, sample.index, missing};
    unapplied_ = 0;
    index_ = sample.index;
  }
}

Gap GapFinder::take() noexcept { return std::exchange(longest_, Gap{}); }

void BurstFinder::received(std::uint32_t number, bool begins) noexcept {
  if (begins || !heard_) {
    *this = {};
    heard_ = true;
    newest_ = number;
    return;
  }
  const auto ahead = static_cast<std::int32_t>(number - newest_);
  if (ahead > -64 && ahead <= 0) came_ |= std::uint64_t{1} << -ahead;
  for (std::int32_t n = 0; n < std::min(ahead, 64); ++n) {
    came_ <<= 1U;
    if (((came_ >> kPatience) & 1U) == 0) {
      ++missing_;
    } else {
      longest_ = std::max(longest_, std::exchange(missing_, 0));
    }
  }
  if (ahead <= 0) return;
  newest_ = number;
  came_ |= 1U;
}

int BurstFinder::take() noexcept { return std::exchange(longest_, 0); }

int RedundancyControl::step(const Losses& losses, const BlockPlace& block) noexcept {
  int burst = losses.states;
  // Where a gap ends with a block, the blocks in it never came; late ones would have ended it anywhere.
  const Gap& gap = losses.commands;
  const int lost = gap.samples / block.samples;
  if (lost > 0 && (block.index - gap.after) % block.samples == 0) {
    // So many blocks in a row were lost as a packet carried, and those that are missing.
    burst = std::max(burst, lost + (gap.before < raised_at_ ? carried_ : copies_));
  }
  // Lengths of bursts are distributed geometrically: twice as long ones are rare.
  const int wanted = std::clamp(2 * burst, settings_.min, settings_.max);
  quiet_s_ = wanted >= copies_ ? 0.0 : quiet_s_ + block.duration_s;
  if (wanted > copies_) {
    carried_ = std::exchange(copies_, wanted);
    raised_at_ = block.index;
  } else if (quiet_s_ >= settings_.hold_s) {
    --copies_;
    quiet_s_ = 0.0;
  }
  return copies_;
}

}  // namespace telekerf::streaming
