// SPDX-License-Identifier: Apache-2.0
// When the slave's end of the command stream gives up delay in a hurry.
#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

#include "tests/unit/streaming/command_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

/// A network that was slow for a while: its delay is kept for what may come again, unless commands are too old.
TEST_F(CommandReceiverTest, AHurryBeginsAtTheBeamsAgeAndEndsAtFourFifthsOfIt) {
  CommandReceiverSettings settings;
  settings.beam_age_s = 1.0;
  CommandReceiver receiver(settings);
  std::deque<std::pair<std::int64_t, CommandBlock>> way;
  std::int64_t lag_ns = 0;
  const auto fastest = [&](int blocks, int delay_ms, double age_s) {
    double pace = 0.0;
    for (int n = 0; n < blocks * kBlock; ++n, now_ns_ += kMs) {
      if (n % kBlock == 0) {
        way.emplace_back(now_ns_ + delay_ms * kMs, next());
        auto& [due_ns, block] = way.back();
        block.echo_sequence = block.sequence;
        block.echo_sent_ns = now_ns_ + lag_ns - static_cast<std::int64_t>(1e9 * age_s);
        receiver.state_sent(block.echo_sequence, block.echo_sent_ns);
      }
      for (; !way.empty() && way.front().first <= now_ns_; way.pop_front())
        receiver.receive({way.front().second, now_ns_}, 4, now_ns_);
      const Played played = receiver.play(now_ns_, kTool);
      if (!played.cursor) continue;
      const std::int64_t before_ns = lag_ns;
      lag_ns = now_ns_ - static_cast<std::int64_t>(1e6 * *played.cursor);
      pace = std::max(pace, 1.0 + static_cast<double>(before_ns - lag_ns) / 1e6);
    }
    return pace;
  };
  (void)fastest(200, 50, 0.3);
  (void)fastest(80, 230, 0.3);
  EXPECT_EQ(fastest(60, 50, 0.97), 1.0) << "fifteen blocks are on the way, here and below";
  (void)fastest(36, 50, 1.03);
  EXPECT_NEAR(fastest(6, 50, 1.03), 1.2, 0.01);
  (void)fastest(12, 50, 0.89);
  EXPECT_NEAR(fastest(4, 50, 0.89), 1.2, 0.01) << "not young yet";
  (void)fastest(12, 50, 0.76);
  EXPECT_NEAR(fastest(6, 50, 0.76), 1.0, 0.006) << "as slowly as ever";
  EXPECT_GT(lag_ns, 110 * kMs) << "there is still something to be given back";
}

}  // namespace
}  // namespace telekerf::streaming
