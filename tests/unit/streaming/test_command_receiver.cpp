// SPDX-License-Identifier: Apache-2.0
// The slave's end of the command stream over a steady link: what is due at each step, and when it has dried
// up.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/streaming/slave_sample.h"
#include "tests/unit/streaming/command_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

TEST_F(CommandReceiverTest, ARecordingHeardFirstGivesWayToWhoEchoesOurState) {
  const CommandBlock recorded = next();
  for (int n = 0; n < 400; ++n) (void)next();
  receiver_.receive({recorded, now_ns_}, 4, now_ns_);
  ASSERT_TRUE(receiver_.heard());
  receiver_.state_sent(5, now_ns_);
  const std::int64_t sent_ns = now_ns_;
  now_ns_ += 10 * kMs;
  change_ = [&](CommandBlock& block) {
    block.echo_sequence = 5;
    block.echo_sent_ns = sent_ns + 1;  // an echo of nothing that was sent
  };
  receiver_.receive({next(), now_ns_}, 4, now_ns_);
  EXPECT_EQ(receiver_.header().sequence, recorded.sequence);
  change_ = [&](CommandBlock& block) {
    block.echo_sequence = 5;
    block.echo_sent_ns = sent_ns;
  };
  const CommandBlock live = next();
  receiver_.receive({live, now_ns_}, 4, now_ns_);
  EXPECT_EQ(receiver_.header().sequence, live.sequence);
}

TEST_F(CommandReceiverTest, PlaysEachSampleOnceInStepAfterBlockLookAheadAndMargin) {
  EXPECT_FALSE(receiver_.play(0, kTool).fresh) << "nothing was heard";
  EXPECT_EQ(receiver_.play(0, kTool).tick, -1.0);
  std::int64_t step = 0;
  run(20, [&](const Played& played) {
    EXPECT_EQ(played.begins, step == 0);
    ASSERT_TRUE(played.fresh && played.cursor);
    // Sample 15 came at 15 ms, and is due 15 + 4 + 2 ms later.
    EXPECT_EQ(*played.cursor, static_cast<double>(step - 6)) << step;
    EXPECT_EQ(played.tick, *played.cursor);
    EXPECT_EQ(played.index, step - 6);
    EXPECT_EQ(played.discontinuity, step == 0) << step;
    EXPECT_EQ(played.sample != nullptr, step >= 6) << step;
    if (played.sample != nullptr) {
      EXPECT_LT((played.state.position_m - place(played.index)).norm(), 1e-6);
      EXPECT_LT((played.sample->value - place(played.index)).norm(), 1e-6);
      EXPECT_NEAR(played.state.velocity_m_per_s.x(), 1e-2, 1e-3);
    }
    ++step;
  });
  EXPECT_EQ(receiver_.clock().corrections(), 0u);
}

TEST_F(CommandReceiverTest, IsFreshUntilTheTimeoutAndWhatThePlayOutWaitsForAreOver) {
  run(10);
  const std::int64_t came_ns = now_ns_ - kBlock * kMs;
  int fresh_ms = 0;
  run(
      20,
      [&](const Played& played) {
        const auto silent_ms = static_cast<int>((now_ns_ - came_ns) / kMs);
        if (played.fresh) fresh_ms = silent_ms;
        EXPECT_EQ(played.cursor.has_value(), played.fresh);
      },
      false);
  EXPECT_NEAR(fresh_ms, 150 + 6, 1);
  EXPECT_FALSE(played_.fresh);
  EXPECT_EQ(played_.sample, nullptr);
}

TEST_F(CommandReceiverTest, ItHasDriedUpAtTheTimeoutItself) {
  receiver_ = CommandReceiver({.playout = {.margin_s = 0.0}, .timeout_s = 0.25});
  receiver_.receive({next(), now_ns_}, 4, now_ns_);
  ASSERT_EQ(receiver_.clock().wait_s(), 0.004) << "the look-ahead";
  EXPECT_TRUE(receiver_.play(now_ns_ + 254 * kMs - 1, kTool).fresh);
  EXPECT_FALSE(receiver_.play(now_ns_ + 254 * kMs, kTool).fresh);
}

TEST_F(CommandReceiverTest, AnotherSampleRateBeginsAnew) {
  run(10);
  change_ = [](CommandBlock& block) {
    block.sample_period_ns = 2'000'000;
    block.ticks_per_sample = 2;
    block.first_tick *= 2;
  };
  receiver_.receive({next(), now_ns_}, 4, now_ns_);
  std::int64_t steps = 0;
  double last = 0.0;
  for (; steps < 30; ++steps, now_ns_ += kMs) {
    played_ = receiver_.play(now_ns_, kTool);
    EXPECT_EQ(played_.begins, steps == 0);
    ASSERT_TRUE(played_.cursor);
    EXPECT_EQ(played_.discontinuity, steps == 0) << steps;
    if (steps > 0) {
      EXPECT_NEAR(*played_.cursor, last + 0.5, 1e-9);
    }
    EXPECT_NEAR(played_.tick, 2.0 * *played_.cursor, 1e-9);
    EXPECT_EQ(played_.index, std::llround(*played_.cursor));
    last = *played_.cursor;
  }
  // Sample 175 comes now, and is due 15 + 4 + 1 samples later; samples from before are of another count.
  EXPECT_NEAR(last, 175 - 20 + 14.5, 1e-9);
  EXPECT_EQ(receiver_.play(now_ns_, kTool).sample != nullptr, true);
}

TEST_F(CommandReceiverTest, HeldCommandsAreOfTheSampleBeforeTheCursorAndBareOnesStartFromTheTool) {
  for (const Law law : {Law::kAnchored, Law::kRemoteAcceleration}) {
    CommandReceiverSettings settings;
    settings.control_period_ns = 500'000;
    receiver_ = CommandReceiver(settings);
    sender_ = Sender<CommandBlock>(7);
    now_ns_ = 15 * kMs;
    change_ = [&](CommandBlock& block) {
      block.law = law;
      block.anchor = {Vec3(1e-3, 0, 0), Vec3(0.02, 0, 0)};
    };
    for (int b = 0; b < 4; ++b) receiver_.receive({next(), now_ns_ + b}, 4, now_ns_);
    now_ns_ += 30 * kMs;
    played_ = receiver_.play(now_ns_, kTool);
    const double whole = *played_.cursor;
    EXPECT_EQ(whole, std::floor(whole));
    EXPECT_EQ(played_.index, static_cast<std::int64_t>(whole));
    const Vec3 at_sample_m = played_.state.position_m;
    const Vec3 acceleration = played_.state.acceleration_m_per_s2;
    played_ = receiver_.play(now_ns_ + kMs / 2, kTool);
    EXPECT_EQ(*played_.cursor, whole + 0.5);
    EXPECT_EQ(played_.index, static_cast<std::int64_t>(whole)) << "held until the next one";
    EXPECT_EQ(played_.state.acceleration_m_per_s2, acceleration);
    EXPECT_LT((acceleration - place(played_.index)).norm(), 1e-6) << "the samples are accelerations now";
    if (law == Law::kAnchored) {
      EXPECT_NEAR(played_.state.position_m.x(), at_sample_m.x() + 0.5e-3 * 0.02, 2e-9);
    } else {
      EXPECT_EQ(played_.state.position_m, kTool.position_m);
      EXPECT_EQ(played_.state.velocity_m_per_s, kTool.velocity_m_per_s);
    }
  }
}

TEST_F(CommandReceiverTest, ACommandIsHeldToTheLastMillionthOfItsSample) {
  for (const std::int64_t short_ns : {5, 0}) {
    CommandReceiverSettings settings;
    settings.control_period_ns = kMs - short_ns;
    receiver_ = CommandReceiver(settings);
    sender_ = Sender<CommandBlock>(7);
    change_ = [](CommandBlock& block) { block.law = Law::kAnchored; };
    for (int b = 0; b < 4; ++b) receiver_.receive({next(), 15 * kMs + b}, 4, 15 * kMs + b);
    const std::int64_t index = receiver_.play(45 * kMs, kTool).index;
    EXPECT_EQ(receiver_.play(46 * kMs, kTool).index, short_ns == 0 ? index + 1 : index);
  }
  EXPECT_EQ(CommandReceiverSettings{}.max_acceleration_m_per_s2, 10.0);
  EXPECT_EQ(CommandReceiverSettings{}.timeout_s, 0.15);
  EXPECT_EQ(CommandReceiverSettings{}.control_period_ns, kMs);
}

TEST_F(CommandReceiverTest, SamplesOfAnotherLawAreNotFollowedWithThisOne) {
  run(10);
  change_ = [](CommandBlock& block) {
    block.law = Law::kAnchored;
    block.engaged_before = 0;
  };
  int strange = 0;
  run(1, [&](const Played& played) {
    if (played.sample == nullptr) return;
    EXPECT_EQ(played.sample->law, Law::kAnchored);
    ++strange;
  });
  EXPECT_EQ(strange, kBlock - 6) << "before its first sample is due there is none";
}

TEST_F(CommandReceiverTest, ALostBlockWithoutACopyIsConcealedAndItsDepthGrows) {
  change_ = [](CommandBlock& block) {
    block.law = Law::kAnchored;
    block.anchor = {Vec3::Zero(), Vec3::Zero()};
  };
  run(10);
  EXPECT_EQ(receiver_.clock().depth_samples(), 17) << "no look-ahead";
  (void)next();
  (void)next();  // its copy rides on the next one
  int concealed = 0;
  run(
      2, [](const Played&) {}, false);
  run(6, [&](const Played& played) {
    concealed += played.sample != nullptr && played.sample->concealed ? 1 : 0;
  });
  EXPECT_EQ(receiver_.counters().lost, 2u);
  EXPECT_EQ(receiver_.clock().depth_samples(), 17 + 16) << "copies are waited for now";
  EXPECT_GT(receiver_.clock().corrections(), 0u);
}

TEST_F(CommandReceiverTest, AnOvertakenBlockIsTakenAsLongAsItCanBePlayed) {
  for (const int more : {0, 1}) {
    receiver_ = CommandReceiver({});
    sender_ = Sender<CommandBlock>(7);
    now_ns_ = 15 * kMs;
    run(3);
    (void)next();
    const CommandBlock late = next();  // samples 64 to 79; the longest block would end at 127
    now_ns_ += 2 * kBlock * kMs;
    run(1);
    // More blocks come until its cursor is just before or after that end.
    for (int n = 0; *played_.cursor < 126.0 + more; ++n, now_ns_ += kMs) {
      if (n % kBlock == 0) receiver_.receive({next(), now_ns_}, 4, now_ns_);
      played_ = receiver_.play(now_ns_, kTool);
    }
    EXPECT_NEAR(*played_.cursor, 126.5 + more, 0.5);
    receiver_.receive({late, now_ns_}, 4, now_ns_);
    EXPECT_EQ(receiver_.counters().stale, static_cast<std::uint64_t>(more)) << more;
  }
}

TEST_F(CommandReceiverTest, AnOvertakenBlockWhoseLastSampleIsHalfASampleAgoIsOfNoUse) {
  for (const double more : {0.0, 0.5}) {
    CommandReceiverSettings settings;
    settings.control_period_ns = kMs / 2;
    receiver_ = CommandReceiver(settings);
    sender_ = Sender<CommandBlock>(7);
    for (int b = 0; b < 3; ++b)
      receiver_.receive({next(), (15 + b * kBlock) * kMs}, 4, (15 + b * kBlock) * kMs);
    (void)next();
    const CommandBlock late = next();  // samples 64 to 79; the longest block would end at 127
    now_ns_ = (15 + 5 * kBlock) * kMs;
    for (int b = 0; b < 4; ++b) receiver_.receive({next(), now_ns_}, 4, now_ns_);
    for (played_ = {}; !played_.cursor || *played_.cursor < 126.75 + more; now_ns_ += kMs / 2)
      played_ = receiver_.play(now_ns_, kTool);
    ASSERT_EQ(*played_.cursor, 127.0 + more);
    receiver_.receive({late, now_ns_}, 4, now_ns_);
    EXPECT_EQ(receiver_.counters().stale, more > 0.0 ? 1u : 0u);
  }
}

/// The network stands still for 192 ms, and then all comes at once.
TEST_F(CommandReceiverTest, WhatComesLateIsPlayedFromWhereItStoodAndNothingIsLeftOut) {
  receiver_ = CommandReceiver({.playout = {.jitter_quantile = 0.9}});  // once is not usual
  run(200);
  const std::int64_t last = played_.index;
  std::vector<CommandBlock> queue;
  for (int b = 0; b < 12; ++b) queue.push_back(next());
  int step = 0;
  run(
      12,
      [&](const Played& played) {
        ++step;
        if (played.sample != nullptr || !played.fresh) return;
        // 6 more are there; 30 ms are gone on for.
        EXPECT_EQ(played.waits, step >= 6 + 30) << step;
        if (played.waits) {
          EXPECT_EQ(*played.cursor, static_cast<double>(last + 7)) << step;
        }
      },
      false);
  EXPECT_FALSE(played_.fresh) << "by now";
  for (const CommandBlock& block : queue) receiver_.receive({block, now_ns_}, 4, now_ns_);
  std::int64_t index = last + 6;
  double pace = 0.0;
  double fastest = 0.0;
  double lag_ms = 0.0;
  run(100, [&](const Played& played) {
    ASSERT_NE(played.sample, nullptr);
    EXPECT_FALSE(played.waits || played.discontinuity);
    EXPECT_LE(played.index, index + 2) << "none is left out but by a faster pace";
    EXPECT_GE(played.index, index);
    index = played.index;
    const double now = played.state.velocity_m_per_s.x() / 1e-2;
    EXPECT_NEAR(now, pace, 0.03) << "it sets off and goes on without a jump";
    pace = now;
    fastest = std::max(fastest, pace);
    lag_ms = static_cast<double>(now_ns_) / kMs - *played.cursor;
  });
  EXPECT_NEAR(fastest, 1.2, 0.01) << "a fifth faster";
  EXPECT_NEAR(lag_ms, 21 + 3, 3) << "until it has caught up";
  EXPECT_EQ(receiver_.clock().resyncs(), 0u);
}

TEST_F(CommandReceiverTest, WhatDoesNotComeAtAllIsLeftOut) {
  run(20);
  const std::int64_t last = played_.index;
  for (int b = 0; b < 6; ++b) (void)next();
  run(
      6, [](const Played&) {}, false);
  EXPECT_TRUE(played_.waits);
  EXPECT_EQ(*played_.cursor, static_cast<double>(last + 7));
  receiver_.receive({next(), now_ns_}, 4, now_ns_);
  played_ = receiver_.play(now_ns_, kTool);
  for (int n = 0; n < 30 && played_.sample == nullptr; ++n) {
    EXPECT_LE(*played_.cursor, static_cast<double>(now_ns_) / kMs - 21) << "no sooner than it is due";
    now_ns_ += kMs;
    played_ = receiver_.play(now_ns_, kTool);
  }
  ASSERT_NE(played_.sample, nullptr);
  EXPECT_EQ(played_.index, last + 7 + 5 * kBlock) << "a copy of the block before rides on the one that came";
  EXPECT_LT((played_.state.position_m - place(played_.index)).norm(), 1e-6);
}

TEST_F(CommandReceiverTest, SaysOfTheStreamWhatItsNewestBlockSaid) {
  StateHeader header;
  receiver_.describe({}, header);
  EXPECT_EQ(header.echo_sequence, 0u);
  change_ = [](CommandBlock& block) {
    block.beta = 0.25;
    block.ticks_per_sample = 3;
    block.first_tick *= 3;
  };
  run(5);
  receiver_.describe({.index = 20, .age = 2, .bitmap = 7}, header);
  EXPECT_EQ(header.applied_tick, 60u);
  EXPECT_EQ(header.applied_age_ticks, 2u);
  EXPECT_EQ(header.applied_bitmap, 7u);
  EXPECT_EQ(header.master_epoch, 7u);
  EXPECT_EQ(header.beta, 0.25);
  EXPECT_EQ(header.playout_ticks, receiver_.clock().depth_samples());
  EXPECT_EQ(header.playout_ticks, 21);
  EXPECT_EQ(header.echo_sequence, 5u);
  EXPECT_EQ(header.echo_sent_ns, (5 * kBlock - 1) * kMs);
  EXPECT_EQ(header.echo_received_ns, now_ns_ - kBlock * kMs);
}

/// Stopped for two seconds, as by SIGSTOP: what has queued up is stamped when it wakes.
TEST_F(CommandReceiverTest, AQueueFromASleepIsNotTakenForTheLink) {
  run(200);
  const int depth = receiver_.clock().depth_samples();
  constexpr int kMissed = 125;
  now_ns_ += kMissed * kBlock * kMs;
  for (int n = 0; n < kMissed; ++n) receiver_.receive({next(), now_ns_}, 4, now_ns_);
  run(3);
  EXPECT_EQ(receiver_.clock().depth_samples(), depth);
  const double made = static_cast<double>(now_ns_) / kMs;
  EXPECT_NEAR(played_.tick, made - depth, 32.0) << "and not two seconds ago";
  EXPECT_EQ(receiver_.counters().refused + receiver_.counters().lost, 0u);
}

TEST_F(CommandReceiverTest, AStepThatIsATenthOfASecondLateWasLateAndALaterOneSlept) {
  for (const std::int64_t more_ns : {0, 1}) {
    run(50);
    EXPECT_FALSE(played_.discontinuity);
    now_ns_ += 100 * kMs + more_ns;
    receiver_.receive({next(), now_ns_}, 4, now_ns_);
    played_ = receiver_.play(now_ns_, kTool);
    EXPECT_TRUE(played_.fresh);
    EXPECT_EQ(played_.discontinuity, more_ns > 0) << more_ns;
    now_ns_ += kMs;
  }
}

TEST(Played, WhatNobodyHasSaidAllowsNothing) {
  const StreamSample sample;
  EXPECT_FALSE(sample.button || sample.engaged || sample.concealed);
  EXPECT_EQ(sample.generation, 0u);
  EXPECT_EQ(sample.block, 0u);
  EXPECT_FALSE(Played{}.fresh || Played{}.begins);
  CommandReceiver receiver{{}};
  const Played played = receiver.play(0, {});
  EXPECT_FALSE(played.begins || played.fresh || played.cursor);
  EXPECT_TRUE(played.discontinuity);
  EXPECT_EQ(played.sample, nullptr);
  EXPECT_EQ(played.tick, -1.0);
  EXPECT_EQ(played.index, -1);
  StateHeader header;
  receiver.describe({}, header);
  EXPECT_EQ(header.echo_received_ns, 0);
  EXPECT_EQ(header.echo_sequence, 0u);
  EXPECT_EQ(header.applied_tick, 0u);
  EXPECT_EQ(header.applied_age_ticks, 0u);
  EXPECT_EQ(header.playout_ticks, 0);
  EXPECT_EQ(SlaveSample{}.index, -1);
  EXPECT_EQ(SlaveSample{}.time, 0);
  EXPECT_FALSE(SlaveSample{}.applied);
}

}  // namespace
}  // namespace telekerf::streaming
