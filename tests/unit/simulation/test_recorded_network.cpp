// SPDX-License-Identifier: Apache-2.0
// A replay's blocks fare as those of the recorded run did.
#include <gtest/gtest.h>

#include <memory>

#include "experiments/replay/recorded_network.h"
#include "netem/core/emulator.h"

namespace telekerf::experiments {
namespace {

BlockRow row(bool received, std::uint32_t epoch, std::uint32_t sequence, std::uint64_t tick, double t_s) {
  BlockRow block{.tick = tick, .t_s = t_s, .received = received};
  block.epoch = epoch;
  block.sequence = sequence;
  return block;
}

TEST(RecordedNetwork, EachBlockHasItsOwnDelayAndWhatNeverCameIsLost) {
  // The receiver's clock is 100 s ahead; number 2 never comes, number 3 comes twice; epoch 8 is another
  // sender.
  const std::vector<BlockRow> sent = {row(false, 7, 0, 96, 0.096), row(false, 7, 1, 116, 1.016),
                                      row(true, 9, 1, 120, 1.0), row(false, 7, 2, 132, 1.032),
                                      row(false, 7, 3, 148, 1.048)};
  const std::vector<BlockRow> heard = {row(true, 7, 1, 40, 101.066), row(false, 7, 2, 41, 101.07),
                                       row(true, 8, 2, 42, 101.08), row(true, 7, 3, 60, 101.088),
                                       row(true, 7, 3, 70, 101.188)};
  const auto blocks = recorded_blocks(sent, heard, 100, 100.0);
  ASSERT_EQ(blocks.size(), 3u) << "what was sent before the first row is left out";
  EXPECT_EQ(blocks[0].tick, 16u);
  EXPECT_NEAR(blocks[0].delay_s, 0.05, 1e-9);
  EXPECT_FALSE(blocks[0].lost);
  EXPECT_TRUE(blocks[1].lost);
  EXPECT_EQ(blocks[2].tick, 48u);
  EXPECT_NEAR(blocks[2].delay_s, 0.04, 1e-9);
}

TEST(RecordedNetwork, ABlockOfTheReplayFaresAsTheRecordedOneThatItIs) {
  netem::DirectionProfile direction;
  direction.recording = std::make_shared<const netem::Recording>(
      trace_of(std::vector<RecordedBlock>{{16, 0.05, false}, {32, 0.0, true}, {48, 0.04, false}}, 2.0, 1e-3));
  // A tick early or late is the same block still.
  for (const int off_ms : {-1, 0, 1}) {
    const auto at_ns = [&](int tick) { return (2000 + tick + off_ms) * std::int64_t{1'000'000}; };
    netem::Emulator emulator(direction, {.seed = 1});
    EXPECT_EQ(emulator.push(at_ns(16), 100, 0).due_ns - at_ns(16), 50'000'000) << off_ms;
    EXPECT_TRUE(emulator.push(at_ns(32), 100, 0).lost()) << off_ms;
    EXPECT_EQ(emulator.push(at_ns(48), 100, 0).due_ns - at_ns(48), 40'000'000) << off_ms;
  }
}

}  // namespace
}  // namespace telekerf::experiments
