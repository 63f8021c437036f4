// SPDX-License-Identifier: Apache-2.0
// What operators ask for by event, in virtual time: engaging, disengaging, another scale, stop and its end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/simulation/simulation.h"

namespace telekerf::simulation {
namespace {

using Kind = EventMessage::Kind;

constexpr double kRtt_s = 0.1;
/// After a decision: a block is filled, crosses the link, waits to be played, and its answer comes back.
constexpr double kAnswer_s = kRtt_s + 0.2;

TimedEvent at(double at_s, Kind kind, double value = 0.0) {
  TimedEvent timed;
  timed.at_s = at_s;
  timed.event.kind = kind;
  timed.event.value = value;
  return timed;
}

RunRecord run(std::vector<TimedEvent> events, double duration_s, bool engage = false,
              std::vector<TimedStop> stops = {}) {
  SimulationSettings settings;
  settings.network = netem::simple_profile(kRtt_s, 0.0, 0.0);
  settings.duration_s = duration_s;
  settings.master.engage = engage;
  settings.events = std::move(events);
  settings.stops = std::move(stops);
  return simulate(settings);
}

/// Rows of [from_s, to_s) that satisfy `test`, as a share of all of them.
template <class Row, class Test>
double share(const std::vector<Row>& rows, double from_s, double to_s, Test test) {
  double all = 0.0;
  double good = 0.0;
  for (const Row& row : rows) {
    if (row.t_s < from_s || row.t_s >= to_s) continue;
    all += 1.0;
    good += test(row) ? 1.0 : 0.0;
  }
  EXPECT_GT(all, 0.0);
  return good / all;
}

const auto kEngaged = [](const MasterRow& row) { return row.engaged; };
const auto kFollows = [](const SlaveRow& row) { return row.applied >= 0.0; };
const auto kBeam = [](const SlaveRow& row) { return row.laser_w > 0.0; };

double motion_m(const std::vector<SlaveRow>& rows, double from_s, double to_s) {
  double largest = 0.0;
  const SlaveRow* first = nullptr;
  for (const SlaveRow& row : rows) {
    if (row.t_s < from_s || row.t_s >= to_s) continue;
    if (first == nullptr) first = &row;
    largest =
        std::max(largest, std::hypot(row.tool_m[0] - first->tool_m[0], row.tool_m[1] - first->tool_m[1]));
  }
  return largest;
}

TEST(OperatorEvents, WhatWasAskedForLongBeforeTheSlaveCouldFollowComesToNothing) {
  SimulationSettings settings;
  settings.duration_s = 20.0;
  settings.slave_starts_s = 12.0;
  settings.master.engage = false;
  for (const double asked_s : {4.0, 10.0}) {
    settings.events = {at(asked_s, Kind::kEngage)};
    const RunRecord record = simulate(settings);
    const double led = share(record.master, 12.5, 20.0, kEngaged);
    EXPECT_EQ(led, asked_s < 6.0 ? 0.0 : 1.0) << asked_s;
  }
}

TEST(OperatorEvents, TheSlaveFollowsFromEngagingToDisengaging) {
  const RunRecord record = run({at(4.0, Kind::kEngage), at(8.0, Kind::kDisengage)}, 10.0);
  EXPECT_EQ(share(record.master, 0.0, 4.0, kEngaged), 0.0) << "nobody has asked for it";
  EXPECT_EQ(share(record.master, 4.001, 8.0, kEngaged), 1.0);
  EXPECT_EQ(share(record.master, 8.001, 10.0, kEngaged), 0.0);
  EXPECT_EQ(share(record.slave, 0.0, 4.0, kFollows), 0.0);
  EXPECT_EQ(share(record.slave, 4.0 + kAnswer_s, 8.0, kFollows), 1.0);
  EXPECT_EQ(share(record.slave, 8.0 + kAnswer_s, 10.0, kFollows), 0.0);
  EXPECT_GT(share(record.slave, 6.0, 8.0, kBeam), 0.1);
  EXPECT_EQ(share(record.slave, 8.0 + kAnswer_s, 10.0, kBeam), 0.0);
  EXPECT_LT(motion_m(record.slave, 8.0 + kAnswer_s + 0.3, 10.0), 50e-6) << "and rests";
}

TEST(OperatorEvents, AStopHoldsBothUntilItIsCleared) {
  const RunRecord record = run({at(10.0, Kind::kEngage)}, 14.0, true, {{5.0, {1, {0}}}, {7.0, {0, {1}}}});
  const auto stopped = [](const SlaveRow& row) {
    return row.interlock == static_cast<int>(Interlock::kStopped);
  };
  EXPECT_EQ(share(record.master, 4.5, 5.0, kEngaged), 1.0);
  EXPECT_EQ(share(record.master, 5.001, 7.0, kEngaged), 0.0);
  EXPECT_EQ(share(record.master, 5.001, 7.0, [](const MasterRow& row) { return row.guided; }), 0.0);
  EXPECT_EQ(share(record.slave, 5.001, 7.0, stopped), 1.0) << "at once, whatever is still on its way";
  EXPECT_EQ(share(record.slave, 5.001, 7.0, kBeam), 0.0);
  EXPECT_LT(motion_m(record.slave, 5.5, 7.0), 50e-6);
  EXPECT_EQ(share(record.slave, 7.001, 14.0, stopped), 0.0);
  EXPECT_EQ(share(record.master, 5.001, 10.0, kEngaged), 0.0) << "nothing comes back by itself";
  EXPECT_EQ(share(record.slave, 5.001, 10.0, kFollows), 0.0);
  EXPECT_EQ(share(record.master, 10.01, 14.0, kEngaged), 1.0);
  EXPECT_GT(share(record.slave, 12.0, 14.0, kBeam), 0.1);
  EXPECT_EQ(share(record.slave, 13.0, 14.0, kFollows), 1.0);
}

TEST(OperatorEvents, AnotherScaleIsTakenUpAndOneThatDoesNotFitIsNot) {
  // 0.02 would lead the master far out of its workspace; 100 is out of bounds.
  const RunRecord record =
      run({at(4.5, Kind::kSetBeta, 0.6), at(4.6, Kind::kDisengage), at(5.0, Kind::kSetBeta, 0.8),
           at(8.0, Kind::kEngage), at(9.0, Kind::kSetBeta, 0.02), at(10.0, Kind::kSetBeta, 100.0)},
          12.0, true);
  const auto scaled = [](double beta) { return [beta](const MasterRow& row) { return row.beta == beta; }; };
  EXPECT_GT(share(record.slave, 4.3, 4.5, kBeam), 0.5);
  EXPECT_EQ(share(record.master, 0.0, 5.0, scaled(0.5)), 1.0) << "not while the beam is on";
  EXPECT_EQ(share(record.master, 5.002, 12.0, scaled(0.8)), 1.0);
  EXPECT_EQ(share(record.master, 8.5, 12.0, kEngaged), 1.0) << "led to the new curve, and engaged there";
  EXPECT_EQ(share(record.slave, 9.0, 12.0, kFollows), 1.0) << "a refusal disturbs nobody";
  double worst_m = 0.0;
  for (const SlaveRow& row : record.slave) {
    if (row.t_s < 10.0 || row.applied < 0.0) continue;
    const MasterRow& then = record.master[static_cast<std::size_t>(std::llround(row.applied))];
    worst_m = std::max(
        worst_m, std::hypot(row.tool_m[0] - 0.8 * then.tool_m[0], row.tool_m[1] - 0.8 * then.tool_m[1]));
  }
  EXPECT_LT(worst_m, 1e-3) << "slave motion = beta x master motion";
}

TEST(OperatorEvents, ARunWithEventsIsRepeatedBitForBit) {
  const std::vector<TimedEvent> events{at(3.0, Kind::kEngage), at(4.0, Kind::kSetBeta, 0.7)};
  const std::vector<TimedStop> stops{{6.0, {1, {0}}}, {6.5, {0, {1}}}};
  const RunRecord once = run(events, 8.0, false, stops);
  const RunRecord again = run(events, 8.0, false, stops);
  ASSERT_EQ(once.slave.size(), again.slave.size());
  for (std::size_t i = 0; i < once.slave.size(); ++i) ASSERT_EQ(once.slave[i].tool_m, again.slave[i].tool_m);
}

/// The button stays down; the hand is gone for two seconds.
TEST(DeadManSwitch, AHandThatLetsGoTakesTheLightWithItUntilTheButtonIsPressedAnew) {
  SimulationSettings settings;
  settings.network = netem::simple_profile(kRtt_s, 0.0, 0.0);
  settings.duration_s = 14.0;
  settings.master.button = "pressed";
  master::OperatorDisturbance let_go;
  let_go.kind = master::OperatorDisturbance::Kind::kLetGo;
  let_go.at_s = 5.0;
  let_go.for_s = 2.0;
  settings.master.hand.disturbances = {let_go};
  const RunRecord record = simulate(settings);
  const auto guided = std::find_if(record.master.begin(), record.master.end(),
                                   [](const MasterRow& row) { return row.guided; });
  ASSERT_NE(guided, record.master.end());
  const double gone_s = guided->t_s + 5.0;
  EXPECT_GT(share(record.slave, gone_s - 1.0, gone_s, kBeam), 0.9);
  // What the observer still feels, the patience, a block, and the way.
  const double dark_s = gone_s + 0.1 + 0.3 + kAnswer_s;
  EXPECT_EQ(share(record.slave, dark_s, 14.0, kBeam), 0.0) << "though the hand is back";
}

}  // namespace
}  // namespace telekerf::simulation
