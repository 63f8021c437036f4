// SPDX-License-Identifier: Apache-2.0
// The button is of each sample: over a link that loses, doubles and overtakes blocks none is played pressed
// that was not pressed, and none that only bridges a gap.
#include <map>
#include <random>
#include <vector>

#include "tests/unit/streaming/command_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

class Buttons : public CommandReceiverTest, public testing::WithParamInterface<std::uint64_t> {};

TEST_P(Buttons, ArePlayedPressedOnlyWhereTheyWerePressed) {
  std::mt19937_64 random(GetParam());
  const double loss = static_cast<double>(random() % 5) * 0.1;
  if (GetParam() % 2 == 0) change_ = [](CommandBlock& block) { block.law = Law::kAnchored; };
  std::vector<bool> truth;  // by stream index
  std::multimap<std::int64_t, CommandBlock> under_way;
  int pressed = 0;
  for (std::int64_t step = 0; step < 12'000; ++step, now_ns_ += kMs) {
    if (step % kBlock == 0) {
      sender_.button = random() & 0xFFFFU;
      if (random() % 3 == 0) sender_.button = random() % 2 == 0 ? 0xFFFFU : 0U;
      const CommandBlock block = next();
      for (int n = 0; n < kBlock; ++n) truth.push_back((sender_.button >> n & 1U) != 0);
      for (int copy = 0; copy < (random() % 5 == 0 ? 2 : 1); ++copy)
        if (static_cast<double>(random() % 1000) * 1e-3 >= loss)
          under_way.emplace(step + static_cast<std::int64_t>(random() % (random() % 4 == 0 ? 120 : 20)),
                            block);
    }
    for (; !under_way.empty() && under_way.begin()->first <= step; under_way.erase(under_way.begin()))
      receiver_.receive({under_way.begin()->second, now_ns_}, 4, now_ns_);
    const Played played = receiver_.play(now_ns_, kTool);
    if (played.sample == nullptr) continue;
    if (!played.sample->button) continue;
    ++pressed;
    ASSERT_FALSE(played.sample->concealed) << step;
    ASSERT_TRUE(truth.at(static_cast<std::size_t>(played.index))) << step;
  }
  EXPECT_GT(pressed, 500);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Buttons, testing::Range<std::uint64_t>(1, 21));

}  // namespace
}  // namespace telekerf::streaming
