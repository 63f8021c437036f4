// SPDX-License-Identifier: Apache-2.0
// What concerns more than one page or one process of the cell: stops, networks, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/protocol/network_choice.h"
#include "tests/unit/console/console_cell.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::master {
namespace {

TEST_F(ConsoleTest, WhoeverTakesTheHandAfterAStopMayClearItAndDrives) {
  const auto station = [](const std::string& role, std::uint32_t epoch) {
    return PresenceMessage{.contract = 0, .cell = "c", .role = role, .name = role, .epoch = epoch, .joined = true, .version = ""};
  };
  const std::vector<PresenceMessage> cell{station("master", 1), station("slave", 2)};
  const auto obey = [&] {
    const StopMessage said = console.stop().step(cell, now_ns).value_or(StopMessage{});
    for (const PresenceMessage& one : cell)
      console.stop().hear({one.epoch, said.number, said.source, said.set, true, said.reason});
    for (int n = 0; n < 50; ++n, pass(20)) (void)console.stop().step(cell, now_ns);
  };
  take(first);
  read(first);
  say(second, R"({"do":"stop"})");
  obey();
  EXPECT_TRUE(console.stop().in_force());
  take(second);
  EXPECT_EQ(refusal(second), "") << "the stop has taken the hand away";
  pass(100);
  say(second, R"({"do":"clear-stop"})");
  EXPECT_EQ(refusal(second), "") << "and the stop that still holds does not take it again";
  obey();
  EXPECT_FALSE(console.stop().in_force());
  take(second);  // silent for longer than a lease
  say(second, R"({"do":"engage"})");
  ASSERT_EQ(events().size(), 1u);

  take(second);
  read(second);
  console.stop().hear({1, 99, "foot-switch", true, true, "squeezed"});
  pass(8);
  take(first);
  EXPECT_EQ(refusal(first), "") << "so does a stop that no page has said";
}

TEST_F(ConsoleTest, OnlyThePageWhoseFrameItIsLearnsWhenTheMasterActedOnIt) {
  const auto echo_ms = [&](std::uint32_t page) {
    pass(20);
    read(page);
    double ms = 0.0;
    std::memcpy(&ms, state.data() + 16, sizeof(ms));
    return ms;
  };
  take(first);
  read(first);
  move(first, PageFrame::kHeld);
  UdpHandAnswer answer;
  answer.session = lease;
  answer.sequence = hand().at(0).sequence;
  console.hear(answer);
  const auto moved_ms = static_cast<double>(now_ns / kMs);
  EXPECT_EQ(echo_ms(first), moved_ms);
  EXPECT_TRUE(std::isnan(echo_ms(second))) << "of another page's clock";
  say(first, R"({"do":"leave"})");
  take(second);
  EXPECT_TRUE(std::isnan(echo_ms(second))) << "and still when it drives";
}

TEST_F(ConsoleTest, AnotherNetworkIsInForceWhenTheSlaveHasTakenItAndNeverUnderTheBeam) {
  streaming::Sender<StateBlock> slave(7);
  const auto tell = [&](bool laser_on) {
    StateBlock block = slave.next();
    block.laser_on = laser_on;
    console.cell().hear({block, now_ns});
  };
  const EventMessage word{5, EventMessage::Kind::kSetNetem, kNetworkTaken, "lan"};
  take(first);
  read(first);
  tell(true);
  say(first, R"({"do":"netem","text":"lan"})");
  EXPECT_EQ(refusal(first), "No other network while the beam is on; let go of the fire button");
  EXPECT_TRUE(events().empty());
  pass(16);
  tell(false);
  say(first, R"({"do":"netem","text":"lan"})");
  EXPECT_EQ(refusal(first), "");
  ASSERT_EQ(events().size(), 1u);
  pass(100);
  EXPECT_EQ(words(second)["profile"], "") << "asked for, and no more";
  EventMessage refused = word;
  refused.value = kNetworkRefused;
  console.hear(refused, now_ns);
  pass(100);
  EXPECT_EQ(words(second), nullptr) << "nothing new";
  console.hear(word, now_ns);
  pass(100);
  EXPECT_EQ(words(second)["profile"], "lan");
}

TEST_F(ConsoleTest, WhatTheCellRefusesIsSaidOnceOfEachSide) {
  const auto hear = [&](const char* text) {
    console.hear(EventMessage{5, EventMessage::Kind::kAnswer, 1.0, text}, now_ns);
  };
  take(first);
  read(first);
  const std::uint64_t before = console.counters().refused;
  hear("master: contour 4 refused: too tight");
  hear("slave: contour 4 refused: too large");
  hear("vision: the network stays as it is: as at the slave");
  std::vector<std::string> said;
  for (const auto& text : read(first))
    if (text["type"] == "refused") said.push_back(text["why"]);
  EXPECT_EQ(said, (std::vector<std::string>{"master: contour 4 refused: too tight", "slave: contour 4 refused: too large"}));
  pass(300);  // both say it again, as who asks may have been found late
  hear("master: contour 4 refused: too tight");
  hear("slave: contour 4 refused: too large");
  EXPECT_EQ(refusal(first), "");
  EXPECT_EQ(console.counters().refused, before + 2);
  pass(1100);
  hear("master: contour 4 refused: too tight");
  EXPECT_EQ(refusal(first), "master: contour 4 refused: too tight") << "asked for anew";
}

TEST_F(ConsoleTest, WhatTheCellRefusesIsSaidToWhoDrives) {
  take(first);
  read(first);
  console.hear(EventMessage{6, EventMessage::Kind::kAnswer, 1.0, "master: of somebody else"}, now_ns);
  console.hear(EventMessage{5, EventMessage::Kind::kAnswer, 0.0, "master: done"}, now_ns);
  EXPECT_EQ(refusal(first), "");
  console.hear(EventMessage{5, EventMessage::Kind::kAnswer, 1.0, "master: refused, for a reason"}, now_ns);
  EXPECT_EQ(refusal(first), "master: refused, for a reason");
}

TEST_F(ConsoleTest, AScaleThatTheMasterDoesNotTakeIsSaid) {
  take(first);
  read(first);
  say(first, R"({"do":"beta","value":0.05})");
  EXPECT_EQ(refusal(first), "");
  for (int n = 0; n < 3; ++n, pass(1000)) move(first, 0);
  EXPECT_EQ(refusal(first), "The scale stays 1.00: the master cannot take the contour at 0.05 now");
}

}  // namespace
}  // namespace telekerf::master
