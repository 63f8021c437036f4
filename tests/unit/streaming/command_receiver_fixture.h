// SPDX-License-Identifier: Apache-2.0
// A command receiver at the end of a steady link.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "common/streaming/command_receiver.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {

inline const KinematicState kTool{Eigen::Vector3d(5e-3, 0, 0), Eigen::Vector3d(0.1, 0, 0),
                                  Eigen::Vector3d(0, 0, 0)};

/// Blocks of 16 samples that come as soon as they are full.
class CommandReceiverTest : public testing::Test {
 protected:
  CommandBlock next() {
    CommandBlock block = sender_.next();
    block.engaged = true;
    block.engaged_before = 0x7F;
    change_(block);
    const auto last = static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample) + kBlock - 1;
    block.sent_ns = last * block.sample_period_ns + lost_ns_;
    return block;
  }
  /// `steps` steps; `each` may look at what was played.
  template <class Each>
  void run(int blocks, Each each, bool deliver = true) {
    for (int b = 0; b < blocks; ++b) {
      if (deliver) receiver_.receive({next(), now_ns_}, 4, now_ns_);
      for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) {
        played_ = receiver_.play(now_ns_, kTool);
        each(played_);
      }
    }
  }
  void run(int blocks) {
    run(blocks, [](const Played&) {});
  }

  CommandReceiver receiver_{{}};
  Sender<CommandBlock> sender_{7};
  std::function<void(CommandBlock&)> change_ = [](CommandBlock&) {};
  std::int64_t now_ns_ = 15 * kMs;
  std::int64_t lost_ns_ = 0;  ///< by the sender's loop
  Played played_;
};

}  // namespace telekerf::streaming
