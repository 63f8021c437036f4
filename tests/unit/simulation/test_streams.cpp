// SPDX-License-Identifier: Apache-2.0
// The two streams in virtual time: what the command stream costs on the wire and what its coding costs in
// tracking, the slave's force at the master, settings that change in mid-run.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/resources.h"
#include "experiments/codec/codec_streams.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"
#include "master/force_feedback.h"
#include "tests/unit/page_cells.h"

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kMs = 1'000'000;

const HandRecord& hand() {
  static const HandRecord record = record_hand("heart", kStreamLap_s, 1);
  return record;
}

struct Coding {
  int block;
  int redundancy;
  double below_raw;    ///< how many times fewer bytes than bare floats
  double tracking_um;  ///< rms
};

class CommandStreamOnTheWire : public testing::TestWithParam<Coding> {};

TEST_P(CommandStreamOnTheWire, IsFarBelowRawAndTracksLikeIt) {
  const auto [block, redundancy, below_raw, tracking_um] = GetParam();
  const DelayResult raw = coded_run(hand(), "raw", block, redundancy);
  const DelayResult sdct = coded_run(hand(), "sdct", block, redundancy);
  const DelayResult batched = coded_run(hand(), "batched", block, redundancy);
  std::printf(
      "N %d, R %d: %.0f bytes/s, %.2f x below bare floats, %.2f x below batched; tracking %.2f um, raw %.2f "
      "um\n",
      block, redundancy, sdct.wire_bytes_per_s, kRawBytesPerS / sdct.wire_bytes_per_s,
      batched.wire_bytes_per_s / sdct.wire_bytes_per_s, sdct.tracking_rmse_um, raw.tracking_rmse_um);
  EXPECT_LE(below_raw * sdct.wire_bytes_per_s, kRawBytesPerS);
  EXPECT_LE(below_raw * sdct.wire_bytes_per_s, raw.wire_bytes_per_s)
      << "with the block's fields around each sample";
  EXPECT_LE(2.0 * sdct.wire_bytes_per_s, batched.wire_bytes_per_s);
  EXPECT_LE(sdct.tracking_rmse_um, tracking_um);
  EXPECT_LE(raw.tracking_rmse_um, 0.60);
}

INSTANTIATE_TEST_SUITE_P(Codings, CommandStreamOnTheWire,
                         testing::Values(Coding{16, 1, 11.0, 0.68}, Coding{32, 2, 20.0, 1.22}));

TEST(CodecPage, TheCommandStreamCostsAndTracksAsItSays) {
  const auto page = reporting::read_table(TELEKERF_CODEC_PAGE, "stream");
  const auto now = reporting::read_rows(stream_table(hand()).markdown);
  ASSERT_EQ(page.size(), now.size());
  for (std::size_t row = 0; row < page.size(); ++row) {
    ASSERT_EQ(page[row].size(), now[row].size());
    for (std::size_t c = 0; c < now[row].size(); ++c) expect_cell(page[row][c], now[row][c], now[row][0]);
  }
}

TEST(ForceFeedbackOverTheLink, APushOnTheSlavesToolIsSeenAfterTheDelay) {
  slave::StationSettings slave_settings;
  slave_settings.record_s = 0.01;
  slave_settings.node.touched = true;
  slave::Station slave(slave_settings);
  const double max_rms = slave_settings.node.force.max_rms;
  master::StationSettings master_settings;
  master_settings.record_s = 0.01;
  master::Station master(master_settings);
  const netem::Profile network = netem::simple_profile(0.1, 0.005, 0.02);
  simulation::VirtualLink<StateBlock> backward(network.backward, 1, netem::Direction::kBackward);
  std::vector<Received<StateBlock>> states;
  std::vector<Vec3> sent_n;
  constexpr int kPushedAt = 1500;
  const Vec3 push_n(2.0, -1.0, 0.0);
  Vec3 squares = Vec3::Zero();
  Vec3 settled_n = Vec3::Zero();
  int compared = 0;
  int seen_at = 0;
  int estimated_at = 0;
  for (int n = 0; n < 4000; ++n) {
    if (n == kPushedAt) slave.machine().plant()->set_tool_force(push_n);
    const auto out = slave.step(n * kMs, nullptr, {}, {});
    sent_n.push_back(out.force_n);
    if (out.state) backward.push(n * kMs, *out.state);
    states.clear();
    backward.deliver(n * kMs, states);
    const master::SlaveForce seen = master.step(n * kMs, nullptr, states, {}).slave_force;
    if (estimated_at == 0 && n >= kPushedAt && out.force_n.x() > 1.0) estimated_at = n;
    if (!seen.known) continue;
    const Vec3 error = seen.force_n - sent_n[seen.tick];
    squares += error.cwiseAbs2();
    ++compared;
    ASSERT_LT(error.cwiseAbs().maxCoeff(), 4.0 * max_rms) << "sqrt(16) x the RMS error of a block at most";
    if (n < kPushedAt + 50) {
      ASSERT_LT(seen.force_n.x(), 1.0) << n;
    }
    if (seen_at == 0 && seen.force_n.x() > 1.0) seen_at = n;
    if (n >= 3000) settled_n += seen.force_n / 1000.0;
  }
  std::printf(
      "push estimated %d ms, seen %d ms after it; settled at (%.3f, %.3f, %.3f) N; coding error %.4f N rms\n",
      estimated_at - kPushedAt, seen_at - kPushedAt, settled_n.x(), settled_n.y(), settled_n.z(),
      std::sqrt(squares.maxCoeff() / compared));
  EXPECT_GT(compared, 3500);
  EXPECT_LT((settled_n - push_n).norm(), 0.3) << "N: friction and a robot that is 10 % off its file";
  EXPECT_LE(std::sqrt(squares.maxCoeff() / compared), max_rms);
  EXPECT_GE(seen_at - estimated_at, 50) << "one way";
  EXPECT_LE(seen_at - estimated_at, 50 + 16 + 15 + 16) << "... a block, jitter, and a lost packet";
}

TEST(StreamSettingsInMidRun, AreFollowedWithoutAJumpOrARefusedBlock) {
  master::StationSettings master_settings;
  const codec::StreamSettings usual = master_settings.validated().node.command.codec;
  master::CommandStream stream(master_settings.validated().node.command, 1);
  streaming::StateReceiver feedback(0.5, 1, 1);
  master::ForceFeedback force;
  slave::StationSettings slave_settings;
  slave_settings.record_s = 0.01;
  const slave::SlaveSettings reported = slave_settings.validated().node;
  slave::Station slave(slave_settings);
  const auto corridor = slave.prepare(hand().contour);
  const netem::Profile network = netem::simple_profile(0.04, 0.0, 0.0);
  simulation::VirtualLink<CommandBlock> forward(network.forward, 1, netem::Direction::kForward);
  simulation::VirtualLink<StateBlock> backward(network.backward, 1, netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;

  const auto change = [&](std::size_t tick) {
    codec::StreamSettings command = usual;
    codec::StreamSettings positions = reported.feedback;
    codec::StreamSettings forces = reported.force;
    if (tick == 5000) {
      command.block = positions.block = 32;
      command.redundancy = positions.redundancy = forces.redundancy = 2;
      positions.max_rms = 1e-6;
      forces.max_rms = 0.05;
    } else if (tick == 7000) {
      command = codec::with_codec(command, "dpcm");
      positions = codec::with_codec(positions, "batched");
      positions.block = 8;
    } else if (tick != 9000) {
      return;
    }
    stream.change(command);
    slave.change(positions, forces);
  };
  std::map<int, int> blocks;  // by length, of the payload's own saying
  codec::BlockDecoder listener;
  Vec3 last_m_per_s = Vec3::Zero();
  double largest_step = 0.0;
  double squares = 0.0;
  int followed = 0;
  Tick last_force = 0;
  for (std::size_t tick = 0; tick < hand().tool.size(); ++tick) {
    const auto now_ns = static_cast<std::int64_t>(tick) * kMs;
    change(tick);
    states.clear();
    backward.deliver(now_ns, states);
    for (const auto& state : states) {
      const streaming::Feedback& brought = feedback.receive(state);
      stream.received(brought);
      force.received(brought, feedback.header());
    }
    const master::SlaveForce seen = force.step(1e-3);
    EXPECT_GE(seen.tick, last_force);
    last_force = seen.tick;
    const auto block = stream.step(now_ns, tick,
                                   {.tool = hand().tool[tick],
                                    .beta = hand().beta,
                                    .contour_id = hand().contour.id,
                                    .engaged = tick > 500,
                                    .engage = tick > 500 ? 1U : 0U,
                                    .echo_sequence = feedback.heard() ? feedback.header().sequence : 0,
                                    .echo_sent_ns = feedback.heard() ? feedback.header().sent_ns : 0});
    if (block) {
      const auto packet = listener.decode(block->payload.view(), {});
      ASSERT_TRUE(packet);
      ++blocks[(*packet)->block_size];
      forward.push(now_ns, *block);
    }
    commands.clear();
    forward.deliver(now_ns, commands);
    const Vec3 tool_m = *slave.machine().true_tool_m();
    const auto out = slave.step(now_ns, corridor.get(), commands, {});
    if (out.state) backward.push(now_ns, *out.state);
    if (tick > 500) {
      largest_step = std::max(largest_step, (out.reference.velocity_m_per_s - last_m_per_s).norm());
    }
    last_m_per_s = out.reference.velocity_m_per_s;
    if (tick < 3000 || out.applied_tick < 0.0) continue;
    const auto applied = static_cast<std::size_t>(std::llround(out.applied_tick));
    squares += (tool_m - hand().beta * hand().true_tool_m[applied]).squaredNorm();
    ++followed;
  }
  const slave::SlaveCounters counters = slave.node().counters();
  std::printf("tracking %.2f um, largest velocity step %.2f mm/s, %llu ticks missed\n",
              1e6 * std::sqrt(squares / followed), 1e3 * largest_step,
              static_cast<unsigned long long>(counters.missed_ticks));
  EXPECT_EQ(counters.refused + counters.stale + counters.lost, 0u);
  EXPECT_GT(blocks[16], 100);
  EXPECT_GT(blocks[32], 60);
  EXPECT_LT(counters.missed_ticks, 100u) << "the play-out deepens for longer blocks, and no more";
  EXPECT_LT(largest_step, 5.2e-3) << "m/s a tick: a transfer takes 5 m/s^2 at most";
  EXPECT_LT(1e6 * std::sqrt(squares / followed), 40.0);
  EXPECT_GT(last_force, hand().tool.size() - 100);
}

}  // namespace
}  // namespace telekerf::experiments
