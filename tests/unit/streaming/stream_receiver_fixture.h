// SPDX-License-Identifier: Apache-2.0
// A receiver of either stream, and a sender whose blocks it takes.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "common/streaming/stream_receiver.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {

using Kind = Arrival::Kind;
inline constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::min();

template <class Block>
class StreamReceiverTest : public testing::Test {
 protected:
  /// Every 16 ms one.
  Kind take(const Block& block, std::int64_t useful_from = kAlways) {
    last_ = receiver_.receive({block, now_ns_}, useful_from);
    now_ns_ += kBlock * kMs;
    return last_.kind;
  }

  StreamReceiver<Block> receiver_{0.15};
  Sender<Block> sender_{7};
  Arrival last_;
  std::int64_t now_ns_ = 1000 * kMs;
};

using Blocks = testing::Types<CommandBlock, StateBlock>;

}  // namespace telekerf::streaming
