// SPDX-License-Identifier: Apache-2.0
// When the slave is led, and how it is taken hold of: from where it rests it is brought to the master's
// motion without a jump, and it is let go when it does not answer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/control/bumpless_transfer.h"
#include "common/streaming/state_receiver.h"

namespace telekerf::master {

using control::KinematicState;

/// Stream indices count samples of the command stream.
class Engagement {
 public:
  enum class Phase : std::uint8_t {
    kApart,   ///< the slave is not led
    kBegins,  ///< it is led from this block on
    kHolds,   ///< it goes on being led
  };

  Engagement(const control::BumplessTransferSettings& approach, double period_s) noexcept
      : period_s_(period_s), approach_(approach) {}

  /// What the slave has told; `ours`: of one that follows this master.
  void received(std::span<const streaming::SlaveSample> samples, bool ours) noexcept;
  /// Nobody is led by `before` any more; what it knows of the slave goes on.
  void take_over(const Engagement& before) noexcept { slave_m_ = before.slave_m_; }
  /// Where the slave was last seen.
  const std::optional<Vec3>& slave_m() const noexcept { return slave_m_; }

  /// Where the block of `index` begins, and nowhere else: a block is engaged as a whole.
  Phase begin_block(std::int64_t index, bool wanted) noexcept;
  /// The same for a slave that needs no hold: it follows positions by itself.
  Phase begin_block_unaided(bool wanted) noexcept;
  bool engaged() const noexcept { return engaged_; }
  /// Bit n: so was the block n + 1 back. A block's own bit enters when it is finished.
  std::uint8_t engaged_before() const noexcept { return before_; }
  void finish_block(bool engaged) noexcept {
    before_ = static_cast<std::uint8_t>((before_ << 1U) | (engaged ? 1U : 0U)) & 0x7FU;
  }
  /// Older blocks had another scale: their copies are nothing to follow.
  void forget_blocks() noexcept { before_ = 0; }

  /// The slave, now at `from`, is to be brought to `source`; both belong to the next sample.
  void approach(const KinematicState& from, const KinematicState& source) noexcept;
  /// Of one sample, in order: what leads the slave from where it is predicted to the master's scaled motion.
  KinematicState goal(const KinematicState& source, const KinematicState& predicted) noexcept;
  /// Nothing is left of an approach.
  bool aligned() const noexcept;

 private:
  double period_s_;
  std::optional<Vec3> slave_m_;
  bool engaged_ = false;
  std::uint8_t before_ = 0;
  int unacknowledged_ = 0;           ///< samples since it applied anything, while engaged
  bool answered_ = false;            ///< it has applied a command of this engagement
  std::int64_t engaged_index_ = 0;   ///< where the engagement began
  std::int64_t released_until_ = 0;  ///< index
  control::BumplessTransfer approach_;
  bool starts_ = false;  ///< an approach was started at this very sample
};

}  // namespace telekerf::master
