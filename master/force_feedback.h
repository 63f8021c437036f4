// SPDX-License-Identifier: Apache-2.0
// The force on the slave's tool (state stream): a block's samples come at once, and are given out one by one.
#pragma once

#include <cstdint>
#include <vector>

#include "common/streaming/state_receiver.h"

namespace telekerf::master {

/// Force of the world on the slave's tool, N, slave's workpiece frame, as the slave estimated it at `tick`.
struct SlaveForce {
  Vec3 force_n = Vec3::Zero();
  Tick tick = 0;       ///< of the slave
  bool known = false;  ///< false: nothing came yet, or nothing comes any more
};

/// Missing samples are held over. What is left behind (late packets, copies of lost ones) is caught up at
/// double pace; what lies more than a packet behind is left out. No allocation after construction.
class ForceFeedback {
 public:
  ForceFeedback();

  /// `header`: of the same block.
  void received(const streaming::Feedback& feedback, const StateHeader& header) noexcept;
  /// A control step of `dt_s` on.
  SlaveForce step(double dt_s) noexcept;

 private:
  Vec3& at(std::int64_t index) noexcept;

  std::vector<Vec3> ring_;
  std::uint32_t period_ns_ = 0;
  std::uint16_t ticks_per_sample_ = 1;
  std::int64_t newest_ = -1;  ///< index of the newest sample, the slave's count
  std::int64_t block_ = 1;
  double cursor_ = -1.0;  ///< what is given out now; negative: nothing yet
  double silent_s_ = 0.0;
};

}  // namespace telekerf::master
