// SPDX-License-Identifier: Apache-2.0
// The emulated link under two participants on loopback. Only lower bounds of time are asserted: nothing comes
// before it is due; how much later it comes is the machine's business.
#include <gtest/gtest.h>

#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"
#include "tests/unit/bus/cell.h"
#include "tests/unit/bus/samples.h"

namespace telekerf {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

netem::Profile constant(double forward_s, double backward_s) {
  netem::Profile profile;
  profile.forward.stages[0].conditions.delay.delay_s = forward_s;
  profile.backward.stages[0].conditions.delay.delay_s = backward_s;
  return profile;
}

BusSettings emulated(BusSettings settings, const netem::Profile& profile) {
  settings.emulation = Emulation{.profile = profile, .seed = 3};
  return settings;
}

/// Either side learns of the other in its own time.
template <class T>
testing::AssertionResult matched(const Writer<T>& writer, const Reader<T>& reader) {
  return soon([&] { return writer.readers() > 0 && reader.writers() > 0; }) ? testing::AssertionSuccess()
                                                                            : testing::AssertionFailure();
}

/// One-way times of `count` blocks, each written after the one before has come.
template <class T>
std::vector<std::int64_t> one_way_ns(Writer<T>& writer, Reader<T>& reader, int count) {
  std::vector<std::int64_t> times;
  for (int i = 0; i < count; ++i) {
    T block;
    block.sequence = static_cast<std::uint32_t>(i);
    block.sent_ns = monotonic_ns();
    EXPECT_TRUE(writer.write(block));
    if (const auto sample = take_soon(reader)) times.push_back(sample->received_ns - sample->value.sent_ns);
  }
  return times;
}

TEST(Emulation, EachDirectionHasItsOwnDelay) {
  const auto profile = constant(0.030, 0.012);
  Bus master(emulated(settings("master"), profile));
  Bus slave(emulated(settings("slave", Site::kSlave), profile));
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> commands_read(slave);
  Writer<StateBlock> states(slave);
  Reader<StateBlock> states_read(master);
  ASSERT_TRUE(matched(commands, commands_read));
  ASSERT_TRUE(matched(states, states_read));

  const auto forward = one_way_ns(commands, commands_read, 10);
  const auto backward = one_way_ns(states, states_read, 10);
  ASSERT_EQ(forward.size(), 10u);
  ASSERT_EQ(backward.size(), 10u);
  for (const auto ns : forward) EXPECT_GE(ns, 30 * kMillisecond);
  for (const auto ns : backward) EXPECT_GE(ns, 12 * kMillisecond);
  // The backward delay is not the forward one, and both are what virtual time makes of the profile: the least
  // of ten shows it on any machine that works at all.
  EXPECT_LT(*std::min_element(backward.begin(), backward.end()), (12 + 10) * kMillisecond);
  EXPECT_LT(*std::min_element(forward.begin(), forward.end()), (30 + 10) * kMillisecond);
  EXPECT_GT(slave.counters().link.emulated, 10u);
  EXPECT_GE(slave.counters().link.earliest_ns, 0);
  EXPECT_GE(master.counters().link.earliest_ns, 0);
}

TEST(Emulation, WithinASiteThereIsNone) {
  const auto profile = constant(0.2, 0.2);
  Bus vision(emulated(settings("vision", Site::kSlave), profile));
  Bus slave(emulated(settings("slave", Site::kSlave), profile));
  Writer<StateBlock> writer(vision);
  Reader<StateBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  const auto times = one_way_ns(writer, reader, 10);
  ASSERT_EQ(times.size(), 10u);
  EXPECT_LT(*std::min_element(times.begin(), times.end()), 200 * kMillisecond);
  EXPECT_EQ(slave.counters().link.emulated, 0u);
}

TEST(Emulation, NothingComesBeforeItsDrawnDueTime) {
  netem::Profile profile = constant(0.0, 0.0);
  auto& conditions = profile.forward.stages[0].conditions;
  conditions.delay.law = netem::Law::kUniform;
  conditions.delay.delay_s = 0.010;
  conditions.delay.jitter_s = 0.004;
  conditions.duplicate = 0.1;
  Bus master(emulated(settings("master"), profile));
  Bus slave(emulated(settings("slave", Site::kSlave), profile));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  CommandBlock block;
  for (int i = 0; i < 200; ++i) {
    block.sent_ns = monotonic_ns();
    ASSERT_TRUE(writer.write(block));
    sleep_until_ns(block.sent_ns + kMillisecond);
  }
  ASSERT_TRUE(soon([&] { return reader.counters().received >= 200; }));
  while (const auto sample = reader.take()) {
    // Least of a uniform law with this mean and standard deviation: 10 - sqrt(3) * 4 ms.
    EXPECT_GE(sample->received_ns - sample->value.sent_ns, 3'071'000);
  }
  EXPECT_GE(slave.counters().link.earliest_ns, 0);
}

TEST(Emulation, BlocksThatWereOvertakenStillArrive) {
  netem::Profile profile = constant(0.0, 0.0);
  auto& conditions = profile.forward.stages[0].conditions;
  conditions.delay.law =
      netem::Law::kUniform;  // 0.3 to 7.7 ms, blocks 2 ms apart: overtaken by three at most
  conditions.delay.delay_s = 0.004;
  conditions.delay.jitter_s = 0.0021;
  conditions.order = netem::Order::kFree;
  Bus master(settings("master"));
  Bus slave(emulated(settings("slave", Site::kSlave), profile));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  CommandBlock block;
  for (std::uint32_t i = 0; i < 200; ++i) {
    block.sequence = i;
    block.sent_ns = monotonic_ns();
    ASSERT_TRUE(writer.write(block));
    sleep_until_ns(block.sent_ns + 2 * kMillisecond);
  }
  EXPECT_TRUE(soon([&] { return reader.counters().received == 200; })) << reader.counters().received;
  int overtaken = 0;
  std::uint32_t newest = 0;
  while (const auto sample = reader.take()) {
    overtaken += sample->value.sequence < newest ? 1 : 0;
    newest = std::max(newest, sample->value.sequence);
  }
  EXPECT_GT(overtaken, 0);
}

TEST(Emulation, LostBlocksAreLostAndEventsArriveAll) {
  netem::Profile profile = constant(0.001, 0.001);
  for (auto* direction : {&profile.forward, &profile.backward}) {
    direction->stages[0].conditions.loss.model = netem::LossModel::kBernoulli;
    direction->stages[0].conditions.loss.loss = 0.2;
  }
  Bus master(settings("master"));  // the way back is clean; the forward way is emulated at the slave
  Bus slave(emulated(settings("slave", Site::kSlave), constant(0.0, 0.0)));
  Writer<EventMessage> events(master);
  Reader<EventMessage> events_read(slave);
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> commands_read(slave);
  ASSERT_TRUE(matched(events, events_read));
  ASSERT_TRUE(matched(commands, commands_read));
  slave.set_profile(profile);

  for (std::uint32_t i = 0; i < 50; ++i) ASSERT_TRUE(events.write(event(i)));
  for (std::uint32_t i = 0; i < 50; ++i) {
    const auto taken = take_soon(events_read);
    ASSERT_TRUE(taken) << i;
    EXPECT_EQ(taken->value.epoch, i);
  }
  const std::uint64_t lost_before = slave.counters().link.lost;
  CommandBlock block;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(commands.write(block));
    std::this_thread::sleep_for(200us);
  }
  EXPECT_TRUE(soon([&] {
    const auto lost = slave.counters().link.lost - lost_before;
    return lost > 0 && commands_read.counters().received + lost >= 200;
  }));
  EXPECT_LT(commands_read.counters().received, 200u);
}

TEST(Emulation, ALargeContourSurvivesLoss) {
  netem::Profile profile = constant(0.010, 0.010);
  for (auto* direction : {&profile.forward, &profile.backward}) {
    direction->stages[0].conditions.loss.model = netem::LossModel::kBernoulli;
    direction->stages[0].conditions.loss.loss = 0.05;
  }
  Bus vision(emulated(settings("vision", Site::kSlave), profile));
  Bus master(emulated(settings("master"), profile));
  Writer<ContourMessage> writer(vision);
  Reader<ContourMessage> reader(master);
  samples::Random random(4);
  const ContourMessage contour = samples::contour(random, 20000);
  ASSERT_TRUE(writer.write(contour));
  const auto taken = take_soon(reader);
  ASSERT_TRUE(taken);
  EXPECT_TRUE(samples::same(contour, taken->value));
}

TEST(Emulation, DamagedBlocksAreRefusedAndCounted) {
  netem::Profile profile = constant(0.0, 0.0);
  profile.forward.stages[0].conditions.corrupt = 0.5;
  Bus master(settings("master"));
  Bus slave(emulated(settings("slave", Site::kSlave), constant(0.0, 0.0)));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  slave.set_profile(profile);
  samples::Random random(1);
  const CommandBlock block = samples::command(random, 40);
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(writer.write(block));
    std::this_thread::sleep_for(200us);
  }
  ASSERT_TRUE(soon([&] { return reader.counters().received > 100 && reader.counters().damaged > 60; }))
      << reader.counters().received << " whole, " << reader.counters().damaged << " damaged";
  // Flips outside the sample never came; of those inside, only the few in CDR's padding pass.
  EXPECT_TRUE(
      soon([&] { return 10 * reader.counters().damaged > 9 * slave.counters().link.delivered_corrupted; }));
  EXPECT_LE(reader.counters().damaged, slave.counters().link.delivered_corrupted);
  EXPECT_GT(slave.counters().link.corrupted, slave.counters().link.delivered_corrupted);
  // A flip that was accepted hit padding: what came is whole.
  while (const auto sample = reader.take()) ASSERT_TRUE(samples::same(block, sample->value));
}

TEST(Emulation, TheNetworkChangesWhileItRuns) {
  Bus master(settings("master"));
  Bus slave(emulated(settings("slave", Site::kSlave), constant(0.0, 0.0)));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  const auto before = one_way_ns(writer, reader, 10);
  EXPECT_LT(*std::min_element(before.begin(), before.end()), 50 * kMillisecond);
  slave.set_profile(constant(0.050, 0.0));
  for (const auto ns : one_way_ns(writer, reader, 5)) EXPECT_GE(ns, 50 * kMillisecond);
  EXPECT_THROW(master.set_profile(constant(0.0, 0.0)), StartupError);
}

}  // namespace
}  // namespace telekerf
