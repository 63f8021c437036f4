// SPDX-License-Identifier: Apache-2.0
// What the slave tells of itself: every field of a block against the steps that it is of.
#include "common/codec/decoder.h"
#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

class StateReportTest : public testing::Test {
 protected:
  static ReportSample sample(Tick tick) {
    const double t = static_cast<double>(tick);
    return {.tool_m = Vec3(1e-5 * t, -2e-3, 0.0),
            .velocity_m_per_s = Vec3(1e-2, 0.0, 0.0),
            .force_n = Vec3(0.5, -1.0, 1e-3 * t),
            .laser_on = tick % 3 == 0,
            .interlock = tick < 40 ? Interlock::kStale : Interlock::kReady,
            .contour_id = 6};
  }
  static StateReportSettings settings(int ticks_per_sample) {
    StateReportSettings settings;
    settings.positions.max_rms = 1e-7;
    settings.positions.block = settings.forces.block = 8;
    settings.positions.redundancy = settings.forces.redundancy = 0;
    settings.forces.max_rms = 1e-3;
    settings.forces.quantum = 1e-4;
    settings.forces.anchored = false;
    settings.ticks_per_sample = ticks_per_sample;
    return settings;
  }
  streaming::CommandReceiver commands_{{}};
};

TEST_F(StateReportTest, ABlockSaysWhatItsSamplesWereAndHowTheLastOneStood) {
  StateReport report(settings(2), 9);
  codec::BlockDecoder positions;
  codec::BlockDecoder forces;
  std::uint32_t number = 0;
  std::uint64_t position_bytes = 0;
  std::uint64_t force_bytes = 0;
  const streaming::Acknowledgement acknowledgement{.index = 30, .age = 4, .bitmap = 5};
  for (Tick tick = 0; tick < 64; ++tick) {
    const auto block =
        report.step(1000 * static_cast<std::int64_t>(tick), tick, sample(tick), commands_, acknowledgement);
    ASSERT_EQ(block.has_value(), tick % 16 == 14) << "eight samples of two ticks";
    if (!block) continue;
    const Tick first = tick - 14;
    EXPECT_EQ(block->sequence, ++number);
    EXPECT_EQ(block->epoch, 9u);
    EXPECT_EQ(block->first_tick, first);
    EXPECT_EQ(block->ticks_per_sample, 2);
    EXPECT_EQ(block->sample_period_ns, 2'000'000u);
    EXPECT_EQ(block->sent_ns, 1000 * static_cast<std::int64_t>(tick));
    EXPECT_EQ(block->laser_on, tick % 3 == 0);
    EXPECT_EQ(block->interlock, tick < 40 ? Interlock::kStale : Interlock::kReady);
    EXPECT_EQ(block->contour_id, 6u);
    EXPECT_EQ(block->applied_tick, 30u);
    EXPECT_EQ(block->applied_age_ticks, 4u);
    EXPECT_EQ(block->applied_bitmap, 5u);
    EXPECT_EQ(block->echo_sequence, 0u) << "nothing was heard";
    const Anchor anchor = to_wire_precision(Anchor{sample(first).tool_m, sample(first).velocity_m_per_s});
    EXPECT_EQ(block->anchor.position_m, anchor.position_m);
    EXPECT_EQ(block->anchor.velocity_m_per_s, anchor.velocity_m_per_s);
    const auto places =
        positions.decode(block->payload.view(), {anchor.position_m, anchor.velocity_m_per_s * 2e-3});
    const auto pushes = forces.decode(block->force.view(), {});
    ASSERT_TRUE(places && pushes);
    for (Tick n = 0; n < 8; ++n) {
      const ReportSample then = sample(first + 2 * n);
      EXPECT_LT(((*places)->blocks_newest_first[0].samples[n] - then.tool_m).norm(), 4e-7);
      EXPECT_LT(((*pushes)->blocks_newest_first[0].samples[n] - then.force_n).norm(), 4e-3);
      EXPECT_EQ((*pushes)->blocks_newest_first[0].button, 0u) << "forces have none";
      EXPECT_EQ(((*places)->blocks_newest_first[0].button >> n) & 1U, then.laser_on ? 1u : 0u);
    }
    position_bytes += block->payload.size;
    force_bytes += block->force.size;
    EXPECT_EQ(report.counters().states, number);
    EXPECT_EQ(report.counters().position_bytes, position_bytes);
    EXPECT_EQ(report.counters().force_bytes, force_bytes);
  }
  EXPECT_EQ(number, 4u);
}

TEST_F(StateReportTest, WhatCannotBeCodedIsNotSentAndOnlyForcesThatCannotBeCostThemselves) {
  StateReport report(settings(1), 9);
  ReportSample wrong = sample(0);
  wrong.force_n.x() = std::nan("");
  std::optional<StateBlock> block;
  Tick tick = 0;
  for (; tick < 8; ++tick) block = report.step(0, tick, tick == 3 ? wrong : sample(tick), commands_, {});
  ASSERT_TRUE(block);
  EXPECT_EQ(block->force.size, 0);
  EXPECT_GT(block->payload.size, 0);
  EXPECT_EQ(report.counters().states, 1u);
  wrong = sample(0);
  wrong.tool_m.x() = std::nan("");
  for (; tick < 16; ++tick) block = report.step(0, tick, tick == 11 ? wrong : sample(tick), commands_, {});
  EXPECT_FALSE(block);
  EXPECT_EQ(report.counters().states, 1u);
  for (; tick < 24; ++tick) block = report.step(0, tick, sample(tick), commands_, {});
  ASSERT_TRUE(block);
  EXPECT_GT(block->force.size, 0);
}

TEST_F(StateReportTest, AnotherBlockLengthHoldsForBothPartsFromTheNextBlock) {
  StateReport report(settings(1), 9);
  Tick tick = 0;
  for (; tick < 3; ++tick) EXPECT_FALSE(report.step(0, tick, sample(tick), commands_, {}));
  codec::StreamSettings positions = settings(1).positions;
  codec::StreamSettings forces = settings(1).forces;
  positions.block = 16;
  report.change(positions, forces);
  std::vector<Tick> full;
  codec::BlockDecoder decoder;
  for (; tick < 40; ++tick) {
    const auto block = report.step(0, tick, sample(tick), commands_, {});
    if (!block) continue;
    full.push_back(tick);
    const auto pushes = decoder.decode(block->force.view(), {});
    ASSERT_TRUE(pushes);
    EXPECT_EQ((*pushes)->block_size, full.size() == 1 ? 8 : 16);
  }
  EXPECT_EQ(full, (std::vector<Tick>{7, 23, 39}));
  positions.block = 1000;
  EXPECT_ANY_THROW(report.change(positions, forces));
}

/// The same of a whole node: what it says is what it did.
TEST_F(SlaveNodeTest, ItsStatesSayWhatItDid) {
  follow(3.0);
  int states = 0;
  codec::BlockDecoder decoder;
  std::vector<Vec3> measured_m;
  double velocity_m_per_s = 0.0;
  each_tick_ = [&] {
    measured_m.push_back(out_.tool_m);
    if (!out_.state) return;
    const StateBlock& state = *out_.state;
    ASSERT_EQ(state.laser_on, out_.laser_w > 0.0);
    ASSERT_EQ(state.interlock, out_.interlock);
    ASSERT_EQ(state.contour_id, 1u);
    ASSERT_EQ(state.master_epoch, epoch_);
    ASSERT_EQ(state.beta, 1.0);
    ASSERT_EQ(state.applied_tick, static_cast<Tick>(std::llround(out_.applied_tick)));
    ASSERT_EQ(state.echo_sequence, number_);
    ASSERT_EQ(state.sent_ns, now_ns_);
    const auto packet =
        decoder.decode(state.payload.view(), {state.anchor.position_m, state.anchor.velocity_m_per_s * 1e-3});
    ASSERT_TRUE(packet);
    ASSERT_NEAR(state.anchor.velocity_m_per_s.norm(), 0.02, 4e-3);
    velocity_m_per_s += state.anchor.velocity_m_per_s.norm() / 20;
    if (measured_m.size() >= 16) {
      for (std::size_t n = 0; n < 16; ++n) {
        ASSERT_LT(
            ((*packet)->blocks_newest_first[0].samples[n] - measured_m[measured_m.size() - 16 + n]).norm(),
            4e-6);
      }
    }
    ++states;
  };
  follow(0.32);
  EXPECT_EQ(states, 20);
  EXPECT_NEAR(velocity_m_per_s, 0.02, 1e-3) << "on the whole";
  corridor_.reset();
  each_tick_ = [&] {
    if (out_.state) {
      ASSERT_EQ(out_.state->contour_id, 0u);
      ASSERT_FALSE(out_.state->laser_on);
    }
  };
  run(next_block());
}

}  // namespace
}  // namespace telekerf::slave
