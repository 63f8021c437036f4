// SPDX-License-Identifier: Apache-2.0
// States and events that no slave and no operator sends, at random: whatever stands in them the master keeps
// its numbers finite, and when they are over it leads its slave again after one engagement.
#include <gtest/gtest.h>

#include "common/runtime/startup_error.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"
#include "tests/unit/hostile_values.h"

namespace telekerf::simulation {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kLeast = HostileValues::kLeast;
constexpr std::int64_t kLargest = HostileValues::kLargest;

class HostileStates : public testing::TestWithParam<std::uint64_t> {
 protected:
  StateBlock changed(StateBlock block, std::int64_t now_ns) {
    const auto again = [&](auto change) {
      if (random_.one_in(6)) change();
    };
    again([&] { block.sequence = random_.some<std::uint32_t>({0, 1, block.sequence + 60, 0xFFFFFFFF}); });
    again([&] { block.epoch = random_.some<std::uint32_t>({0, 0xFFFFFFFF}); });
    again([&] { block.master_epoch = random_.some<std::uint32_t>({0, 0xFFFFFFFF}); });
    again([&] { block.first_tick = random_.some<Tick>({0, block.first_tick + 900, ~Tick{0}}); });
    again([&] {
      block.sample_period_ns = random_.some<std::uint32_t>({0, 10'000, 100'000'000, 0xFFFFFFFF});
    });
    again([&] { block.ticks_per_sample = random_.some<std::uint16_t>({0, 2, 0xFFFF}); });
    again([&] { block.contour_id = random_.some<std::uint32_t>({0, 1}); });
    again([&] { block.beta = random_.some_number(); });
    again([&] { block.anchor.position_m[static_cast<int>(random_() % 3)] = random_.some_number(); });
    again([&] { block.anchor.velocity_m_per_s[static_cast<int>(random_() % 3)] = random_.some_number(); });
    again([&] {
      block.applied_tick = random_.some<Tick>({0, block.applied_tick + 1000, Tick{1} << 63U, ~Tick{0}});
    });
    again([&] { block.applied_age_ticks = random_.some<std::uint32_t>({0, 0x7FFFFFFF, 0xFFFFFFFF}); });
    again([&] { block.applied_bitmap = random_.some<std::uint64_t>({0, ~std::uint64_t{0}}); });
    again([&] { block.playout_ticks = random_.some<std::int32_t>({0, -1, 0x7FFFFFFF, -0x7FFFFFFF - 1}); });
    again([&] {
      block.echo_sequence = random_.some<std::uint32_t>({0, block.echo_sequence + 1, 0xFFFFFFFF});
    });
    again([&] { block.echo_sent_ns = random_.some<std::int64_t>({kLeast, -1, 0, now_ns + kMs, kLargest}); });
    again([&] { block.echo_received_ns = random_.some<std::int64_t>({kLeast, -1, 0, kLargest}); });
    again([&] { block.sent_ns = random_.some<std::int64_t>({kLeast, -1, 0, kLargest}); });
    again([&] { block.mode = static_cast<SlaveMode>(random_() % 4); });
    again([&] { block.engage = random_.some<std::uint32_t>({0, 1, block.engage + 1}); });
    again([&] { block.stop = random_.some<std::uint32_t>({0, 1}); });
    again([&] { block.guards = random_.some<std::uint32_t>({0, kButtonGuard, kAgeGuard}); });
    again([&] { block.command_age_s = random_.some_number(); });
    again([&] { block.payload.size = static_cast<std::uint16_t>(random_() % (Payload::kCapacity + 1)); });
    again([&] { block.force.size = static_cast<std::uint16_t>(random_() % (Payload::kCapacity + 1)); });
    block.guards &= ~kRealLaser;  // a real one ends the unattended master of this test
    return block;
  }
  EventMessage event() {
    EventMessage event;
    event.kind = static_cast<EventMessage::Kind>(random_() % 10);
    event.value = random_() % 4 == 0 ? 0.3 : random_.some_number();
    return event;
  }

  HostileValues random_{GetParam()};
};

TEST_P(HostileStates, BreakNothingAndTheSlaveIsLedAgain) {
  SimulationSettings settings;
  settings.network.forward.stages.front().conditions.delay.delay_s = 0.01;
  settings.network.backward = settings.network.forward;
  settings.master.record_s = settings.slave.record_s = 0.01;
  const ContourMessage contour = find_contour(settings);
  master::Station master(settings.master);
  slave::Station slave(settings.slave);
  auto task = master.prepare(contour);
  const auto corridor = slave.prepare(contour);
  VirtualLink<CommandBlock> forward(settings.network.forward, 1, netem::Direction::kForward);
  VirtualLink<StateBlock> backward(settings.network.backward, 1, netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  std::vector<EventMessage> events;
  constexpr std::int64_t kFrom = 4000, kTo = 6500, kEngage = 9500, kEnd = 12'000;
  int lit_before = 0, lit_after = 0;
  for (std::int64_t n = 0; n < kEnd; ++n) {
    commands.clear();
    states.clear();
    events.clear();
    forward.deliver(n * kMs, commands);
    backward.deliver(n * kMs, states);
    if (n >= kFrom && n < kTo) {
      const std::size_t good = states.size();
      for (std::size_t k = 0; k < good; ++k)
        for (std::uint64_t more = random_() % 12; more > 0; --more)
          states.push_back({changed(states[k].value, n * kMs),
                            states[k].received_ns - static_cast<std::int64_t>(random_() % kMs)});
      if (random_() % 50 == 0) events.push_back(event());
    }
    if (n == kTo) {  // what the operator did not mean
      EventMessage scale;
      scale.kind = EventMessage::Kind::kSetBeta;
      scale.value = settings.master.beta;
      events.push_back(scale);
    }
    if (n == kEngage) {
      EventMessage engage;
      engage.kind = EventMessage::Kind::kEngage;
      events.push_back(engage);
    }
    const auto made = master.step(n * kMs, task.get(), states, events);
    try {
      if (made.prepare_anew) task = master.prepare(contour);
    } catch (const StartupError&) {  // a scale that the robot cannot take: the one before holds
    }
    ASSERT_TRUE(made.currents_a.allFinite() && made.tool_m.allFinite()) << n;
    ASSERT_FALSE(master.machine().failed()) << n << ": " << master.machine().failure();
    ASSERT_EQ(master.obstacle(), nullptr) << n;
    if (made.command) {
      ASSERT_TRUE(made.command->anchor.position_m.allFinite() && std::isfinite(made.command->beta)) << n;
      forward.push(n * kMs, *made.command, 100);
    }
    const auto out = slave.step(n * kMs, corridor.get(), commands);
    ASSERT_FALSE(slave.machine().failed()) << n << ": " << slave.machine().failure();
    if (out.state) backward.push(n * kMs, *out.state, 100);
    lit_before += n < kFrom && out.laser_w > 0.0 ? 1 : 0;
    lit_after += n > kEngage && out.laser_w > 0.0 ? 1 : 0;
  }
  EXPECT_GT(lit_before, 500);
  EXPECT_GT(lit_after, 500) << "led again after one engagement";
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileStates, testing::Range<std::uint64_t>(1, 5));

}  // namespace
}  // namespace telekerf::simulation
