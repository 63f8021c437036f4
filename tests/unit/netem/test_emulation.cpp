// SPDX-License-Identifier: Apache-2.0
// The emulated link under two participants on loopback. Only lower bounds of time are asserted: nothing comes
// before it is due; how much later it comes is the machine's business.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "common/bus/send_event.h"
#include "common/protocol/network_choice.h"
#include "common/runtime/clock.h"
#include "netem/drivers/netem_switch.h"
#include "netem/drivers/receive_path_emulator.h"
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

/// A process whose receive path the emulator stands in.
struct EmulatedBus {
  EmulatedBus(BusSettings settings, const netem::Profile& profile)
      : emulator(std::make_shared<netem::ReceivePathEmulator>(profile, 3, settings.site)), bus([&] {
          settings.receive_filter = emulator;
          return settings;
        }()) {}

  netem::TransportCounters counters() const { return emulator->counters(); }
  operator Bus&() { return bus; }  // NOLINT: it is one

  std::shared_ptr<netem::ReceivePathEmulator> emulator;
  Bus bus;
};

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
  EmulatedBus master(settings("master"), profile);
  EmulatedBus slave(settings("slave", Site::kSlave), profile);
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
  EXPECT_GT(slave.counters().emulated, 10u);
  EXPECT_GE(slave.counters().earliest_ns, 0);
  EXPECT_GE(master.counters().earliest_ns, 0);
}

TEST(Emulation, WithinASiteThereIsNone) {
  const auto profile = constant(0.2, 0.2);
  EmulatedBus vision(settings("vision", Site::kSlave), profile);
  EmulatedBus slave(settings("slave", Site::kSlave), profile);
  Writer<StateBlock> writer(slave);
  Reader<StateBlock> reader(vision);
  ASSERT_TRUE(matched(writer, reader));
  const auto times = one_way_ns(writer, reader, 10);
  ASSERT_EQ(times.size(), 10u);
  EXPECT_LT(*std::min_element(times.begin(), times.end()), 200 * kMillisecond);
  EXPECT_EQ(vision.counters().emulated, 0u);
}

TEST(Emulation, NothingComesBeforeItsDrawnDueTime) {
  netem::Profile profile = constant(0.0, 0.0);
  auto& conditions = profile.forward.stages[0].conditions;
  conditions.delay.distribution = netem::DelayDistribution::kUniform;
  conditions.delay.delay_s = 0.010;
  conditions.delay.jitter_s = 0.004;
  conditions.duplicate = 0.1;
  EmulatedBus master(settings("master"), profile);
  EmulatedBus slave(settings("slave", Site::kSlave), profile);
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
  EXPECT_GE(slave.counters().earliest_ns, 0);
}

TEST(Emulation, BlocksThatWereOvertakenStillArrive) {
  netem::Profile profile = constant(0.0, 0.0);
  auto& conditions = profile.forward.stages[0].conditions;
  conditions.delay.distribution =
      netem::DelayDistribution::kUniform;  // 0.3 to 7.7 ms, blocks 2 ms apart: overtaken by three at most
  conditions.delay.delay_s = 0.004;
  conditions.delay.jitter_s = 0.0021;
  conditions.order = netem::Order::kFree;
  Bus master(settings("master"));
  EmulatedBus slave(settings("slave", Site::kSlave), profile);
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  CommandBlock block;
  for (std::uint32_t i = 0; i < 200; ++i) {
    block.sequence = i;
    const std::uint64_t before = slave.counters().emulated;
    ASSERT_TRUE(writer.write(block));
    // The 2 ms count from where the link has it: blocks that a busy machine takes in all at once are
    // overtaken by more than a stream has lanes, and those the middleware drops.
    ASSERT_TRUE(soon([&] { return slave.counters().emulated > before; })) << i;
    sleep_until_ns(monotonic_ns() + 2 * kMillisecond);
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
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  Writer<EventMessage> events(master);
  Reader<EventMessage> events_read(slave);
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> commands_read(slave);
  ASSERT_TRUE(matched(events, events_read));
  ASSERT_TRUE(matched(commands, commands_read));
  slave.emulator->set_profile(profile);

  for (std::uint32_t i = 0; i < 50; ++i) ASSERT_TRUE(events.write(event(i)));
  for (std::uint32_t i = 0; i < 50; ++i) {
    const auto taken = take_soon(events_read);
    ASSERT_TRUE(taken) << i;
    EXPECT_EQ(taken->value.epoch, i);
  }
  const std::uint64_t lost_before = slave.counters().lost;
  CommandBlock block;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(commands.write(block));
    std::this_thread::sleep_for(200us);
  }
  EXPECT_TRUE(soon([&] {
    const auto lost = slave.counters().lost - lost_before;
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
  EmulatedBus vision(settings("vision", Site::kSlave), profile);
  EmulatedBus master(settings("master"), profile);
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
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  slave.emulator->set_profile(profile);
  samples::Random random(1);
  CommandBlock block = samples::command(random, 40);
  block.epoch = master.settings().epoch;
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(writer.write(block));
    std::this_thread::sleep_for(200us);
  }
  ASSERT_TRUE(soon([&] { return reader.counters().received > 100 && reader.counters().damaged > 60; }))
      << reader.counters().received << " whole, " << reader.counters().damaged << " damaged";
  // Flips outside the sample never came; of those inside, only the few in CDR's padding pass.
  EXPECT_TRUE(
      soon([&] { return 10 * reader.counters().damaged > 9 * slave.counters().delivered_corrupted; }));
  EXPECT_LE(reader.counters().damaged, slave.counters().delivered_corrupted);
  EXPECT_GT(slave.counters().corrupted, slave.counters().delivered_corrupted);
  // A flip that was accepted hit padding: what came is whole.
  while (const auto sample = reader.take()) ASSERT_TRUE(samples::same(block, sample->value));
}

TEST(Emulation, TheNetworkChangesWhileItRuns) {
  Bus master(settings("master"));
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  const auto before = one_way_ns(writer, reader, 10);
  EXPECT_LT(*std::min_element(before.begin(), before.end()), 50 * kMillisecond);
  slave.emulator->set_profile(constant(0.050, 0.0));
  for (const auto ns : one_way_ns(writer, reader, 5)) EXPECT_GE(ns, 50 * kMillisecond);
}

TEST(Emulation, WhatWaitsBeforeABottleneckLeavesAtTheRateOfTheNetworkThatTakesOver) {
  netem::Profile slow = constant(0.0, 0.0);
  slow.forward.stages[0].conditions.rate_bit_per_s = 200.0;  // a block takes several seconds
  slow.forward.stages[0].conditions.queue_bytes = 100'000;
  Bus master(settings("master"));
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  Writer<CommandBlock> writer(master);
  Reader<CommandBlock> reader(slave);
  ASSERT_TRUE(matched(writer, reader));
  ASSERT_EQ(one_way_ns(writer, reader, 1).size(), 1u);
  slave.emulator->set_profile(slow);
  for (std::uint32_t n = 0; n < 3; ++n) {
    CommandBlock block;
    block.sequence = n;
    ASSERT_TRUE(writer.write(block));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(reader.take().has_value());
  const std::int64_t switched_ns = monotonic_ns();
  slave.emulator->set_profile(constant(0.0, 0.0));
  for (int n = 0; n < 3; ++n) ASSERT_TRUE(take_soon(reader).has_value()) << n;
  EXPECT_LT(monotonic_ns() - switched_ns, 2000 * kMillisecond)
      << "the first was to come after several seconds";
}

TEST(Emulation, AnEventSwitchesTheProcessesThatAreEmulated) {
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  Bus master(settings("master"));
  const netem::NetemSwitch switch_of_slave(slave, slave.emulator);
  const netem::NetemSwitch switch_of_master(master, nullptr);  // the real network: it stays
  Bus console(settings("console"));
  Writer<EventMessage> events(console);
  Writer<CommandBlock> commands(master);
  Reader<CommandBlock> commands_read(slave);
  ASSERT_TRUE(events.wait_for_reader(kPatience, 2));
  ASSERT_TRUE(matched(commands, commands_read));
  const std::string file = testing::TempDir() + "/slow.toml";
  std::ofstream(file) << "[forward]\ndelay_ms = 40\n[backward]\ndelay_ms = 40\n";
  EventMessage nonsense;
  nonsense.kind = EventMessage::Kind::kSetNetem;
  nonsense.text = "no-such-network";
  ASSERT_TRUE(events.write(nonsense));
  EventMessage slow = nonsense;
  slow.text = file;
  ASSERT_TRUE(events.write(slow));
  EXPECT_TRUE(soon([&] {
    const auto times = one_way_ns(commands, commands_read, 1);
    return !times.empty() && times[0] >= 40 * kMillisecond;
  }));
}

TEST(Emulation, UnderTheBeamTheNetworkStaysAndWhoAsksIsToldWhy) {
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  netem::NetemSwitch switch_of_slave(slave, slave.emulator);
  auto asking = settings("netem-switch");
  asking.epoch = 9;
  Bus console(asking);
  ASSERT_TRUE(soon([&] { return !console.others().empty(); }));
  EventMessage geo;
  geo.kind = EventMessage::Kind::kSetNetem;
  geo.text = "geo";
  switch_of_slave.beam(true);
  try {
    (void)tell(console, geo, {"slave"});
    ADD_FAILURE();
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("slave: the network stays as it is: not while the beam is on"),
              std::string::npos)
        << refusal.what();
  }
  switch_of_slave.beam(false);
  EXPECT_EQ(tell(console, geo, {"slave", "vision"}), std::vector<std::string>{"slave"});
}

TEST(Emulation, ACellSwitchesTogetherOrNotAtAllAndTheSlaveDecides) {
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  EmulatedBus master(settings("master"), constant(0.0, 0.0));
  netem::NetemSwitch switch_of_slave(slave, slave.emulator);
  const netem::NetemSwitch switch_of_master(master, master.emulator);
  auto asking = settings("netem-switch");
  asking.epoch = 9;
  Bus console(asking);
  ASSERT_TRUE(soon([&] { return console.others().size() == 2 && master.bus.others().size() == 2; }));
  const auto figures = [](const netem::NetemSwitch& of) {
    Metrics all;
    of.add_figures(all);
    return all;
  };
  EventMessage lan;
  lan.kind = EventMessage::Kind::kSetNetem;
  lan.text = "lan";
  switch_of_slave.beam(true);  // which the master need not have seen yet
  std::string refusal;
  const auto refused_by_both = [&] {
    try {
      (void)tell(console, lan, {"master", "slave"});
    } catch (const StartupError& refused) {
      refusal = refused.what();
    }
    return refusal.find("slave: the network stays as it is: not while the beam is on") != refusal.npos &&
           refusal.find("master: the network stays as it is: as at the slave") != refusal.npos;
  };
  EXPECT_TRUE(soon(refused_by_both)) << refusal;  // each is found in its own time
  EXPECT_EQ(figures(switch_of_master)["netem_switched"], 0.0);
  EXPECT_GE(figures(switch_of_master)["netem_refused_by_slave"], 1.0);
  EXPECT_GE(figures(switch_of_slave)["netem_refused_beam_on"], 1.0);
  EXPECT_EQ(figures(switch_of_slave)["netem_switched"], 0.0);
  switch_of_slave.beam(false);
  EXPECT_EQ(tell(console, lan, {"master", "slave"}).size(), 2u);
  EXPECT_GE(figures(switch_of_master)["netem_switched"], 1.0);
}

TEST(Emulation, WhoComesLaterIsToldWhichNetworkIsInForceAndNobodyElseHearsOfItTwice) {
  EmulatedBus slave(settings("slave", Site::kSlave), constant(0.0, 0.0));
  EmulatedBus master(settings("master"), constant(0.0, 0.0));
  const netem::NetemSwitch switch_of_slave(slave, slave.emulator);
  const netem::NetemSwitch switch_of_master(master, master.emulator);
  auto asking = settings("netem-switch");
  asking.epoch = 9;
  Bus first(asking);
  ASSERT_TRUE(soon([&] { return first.others().size() == 2 && master.bus.others().size() == 2; }));
  const EventMessage lan{.kind = EventMessage::Kind::kSetNetem, .text = "lan"};
  ASSERT_EQ(tell(first, lan, {"master", "slave"}).size(), 2u);
  const auto switched = [](const netem::NetemSwitch& of) {
    Metrics all;
    of.add_figures(all);
    return all["netem_switched"];
  };
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const double before = switched(switch_of_master);
  EmulatedBus console(settings("console"), constant(0.0, 0.0));
  Reader<EventMessage> events(console);
  const netem::NetemSwitch switch_of_console(console, console.emulator);
  EXPECT_TRUE(soon([&] { return switched(switch_of_console) > 0.0; })) << "its own receiving side";
  EXPECT_TRUE(soon([&] {
    const auto event = events.take();
    return event && event->value.value == kNetworkTaken && event->value.text == "lan";
  })) << "and its page";
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // all that was said has come
  EXPECT_EQ(switched(switch_of_console), 1.0);
  EXPECT_EQ(switched(switch_of_master), before);
}

}  // namespace
}  // namespace telekerf
