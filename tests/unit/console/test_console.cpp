// SPDX-License-Identifier: Apache-2.0
// Who drives, who watches, and what comes of what pages say; in virtual time, without a socket.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/console/console_cell.h"

namespace telekerf::master {
namespace {

using testing::field_of;

TEST_F(ConsoleTest, OneDrivesAndTheOthersWatch) {
  take(first);
  read(first);
  EXPECT_NE(lease, 0u);
  take(second);
  EXPECT_EQ(refusal(second), "Another page drives; it has to let go of the hand first");
  say(second, R"({"do":"engage"})");
  EXPECT_EQ(refusal(second), "You watch: take the hand first");
  EXPECT_TRUE(events().empty());
  say(first, R"({"do":"engage"})");
  ASSERT_EQ(events().size(), 1u);
  say(first, R"({"do":"leave"})");
  take(second);
  say(second, R"({"do":"disengage"})");
  EXPECT_EQ(events().size(), 1u);
}

TEST_F(ConsoleTest, WithoutTheTokenNobodyDrives) {
  say(first, R"({"do":"take","text":"guessed-token"})");
  EXPECT_NE(refusal(first).find("needs the console's token"), std::string::npos);
  say(first, R"({"do":"engage"})");
  EXPECT_TRUE(events().empty());
}

TEST_F(ConsoleTest, TheDriversFramesAloneReachTheHand) {
  take(first);
  read(first);
  move(first, PageFrame::kHeld);
  move(second, PageFrame::kHeld);
  const auto sent = hand();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].session, lease);
  EXPECT_EQ(sent[0].flags, UdpHandFrame::kHeld);
  EXPECT_FLOAT_EQ(static_cast<float>(sent[0].x_m), 0.001F);
  --lease;
  move(first, PageFrame::kHeld);
  EXPECT_TRUE(hand().empty()) << "of another lease";
}

TEST_F(ConsoleTest, WhatAStalledLineLetsGoOfAtOnceIsDroppedAndCounted) {
  take(first);
  read(first);
  for (int n = 0; n < 20; ++n, pass(20)) move(first, PageFrame::kHeld);
  hand();
  pass(1900);
  for (std::int64_t age_ms = 1900; age_ms >= 0; age_ms -= 20) move(first, PageFrame::kHeld, age_ms);
  EXPECT_EQ(hand().size(), 8u) << "no older than 150 ms";
  now_ns += 20 * kMs;
  read(first);
  EXPECT_EQ(field_of(state, page_field("late_frames")), 88.0F);
}

TEST_F(ConsoleTest, APageOfWhichNothingIsHeardLosesTheHand) {
  take(first);
  read(first);
  say(first, R"({"do":"arm","value":1})");
  pass(2000);
  move(first, PageFrame::kHeld);
  EXPECT_TRUE(hand().empty());
  take(second);
  EXPECT_EQ(refusal(second), "");
}

TEST_F(ConsoleTest, TheFireButtonCountsOnlyWhileTheLaserIsArmed) {
  take(first);
  read(first);
  const auto fire = [&] {
    move(first, PageFrame::kHeld | PageFrame::kTrigger);
    const auto sent = hand();
    return !sent.empty() && (sent.back().flags & UdpHandFrame::kTrigger) != 0;
  };
  EXPECT_FALSE(fire());
  say(first, R"({"do":"arm","value":1})");
  EXPECT_TRUE(fire());
  say(first, R"({"do":"disengage"})");
  EXPECT_FALSE(fire());
  say(first, R"({"do":"arm","value":1})");
  say(first, R"({"do":"beta","value":99})");
  EXPECT_TRUE(fire()) << "a scale that is refused changes nothing";
  say(first, R"({"do":"beta","value":0.7})");
  EXPECT_FALSE(fire()) << "the master lets go of the slave";
  say(first, R"({"do":"arm","value":1})");
  take(first);  // anew
  read(first);
  EXPECT_FALSE(fire());
}

TEST_F(ConsoleTest, AnyoneStopsAndAStopTakesTheHandAway) {
  take(first);
  read(first);
  say(first, R"({"do":"arm","value":1})");
  move(first, PageFrame::kHeld);
  hand();
  say(second, R"({"do":"stop"})");
  const auto sent = hand();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].flags, 0u) << "released, without waiting for the lease";
  ASSERT_TRUE(console.stop().step({}, now_ns));
  move(first, PageFrame::kHeld | PageFrame::kTrigger);
  EXPECT_TRUE(hand().empty());
  pass(50);
  EXPECT_EQ(words(first)["driver"], "nobody");
  say(first, R"({"do":"engage"})");
  EXPECT_EQ(refusal(first), "You watch: take the hand first");
  take(first);
  read(first);
  move(first, PageFrame::kHeld | PageFrame::kTrigger);
  EXPECT_TRUE(hand().empty());
  say(first, R"({"do":"engage"})");
  EXPECT_EQ(refusal(first), "Not engaged: clear the stop first");
  say(first, R"({"do":"arm","value":1})");
  EXPECT_EQ(refusal(first), "Not armed: clear the stop first");
}

TEST_F(ConsoleTest, AClosedPageLetsGo) {
  take(first);
  read(first);
  move(first, PageFrame::kHeld);
  hand();
  console.leave(first, now_ns);
  const auto sent = hand();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].flags, 0u);
  take(second);
  EXPECT_EQ(refusal(second), "");
}

TEST_F(ConsoleTest, WhatIsMalformedOrTooMuchIsCountedAndAStopIsHeardAllTheSame) {
  console.hear_frame(first, {}, now_ns);
  say(first, "no json");
  EXPECT_EQ(console.counters().malformed, 2u);
  take(first);
  read(first);
  for (int n = 0; n < 5000; ++n) move(first, PageFrame::kHeld);
  EXPECT_LE(hand().size(), 1500u);
  EXPECT_GE(console.counters().flooded, 3500u);
  say(first, R"({"do":"stop"})");
  EXPECT_TRUE(console.stop().in_force());
}

TEST_F(ConsoleTest, WhatMayNotBeIsRefusedWithItsReason) {
  take(first);
  read(first);
  say(first, R"({"do":"beta","value":99})");
  EXPECT_NE(refusal(first).find("within [0.01, 10]"), std::string::npos);
  say(first, R"({"do":"netem","text":"/etc/passwd"})");
  EXPECT_NE(refusal(first).find("No network of the name"), std::string::npos);
  say(first, R"({"do":"clear-stop"})");
  EXPECT_EQ(refusal(first), "No stop is in force");
  EXPECT_TRUE(events().empty());
  say(first, R"({"do":"netem","text":"lan"})");
  const auto sent = events();
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].text, "lan");
}

TEST_F(ConsoleTest, WhoDrivesSaysWhatIsMeantInThePicture) {
  say(second, R"({"do":"look","text":"at 0.001,0.002"})");
  EXPECT_EQ(refusal(second), "You watch: take the hand first");
  take(first);
  read(first);
  say(first, R"({"do":"look","text":"at 0.001,0.002"})");
  auto said = events();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].kind, EventMessage::Kind::kLook);
  EXPECT_EQ(said[0].text, "at 0.001,0.002");
  EXPECT_EQ(said[0].epoch, 5u) << "whoever answers answers this console";

  say(first, R"({"do":"take-contour"})");
  EXPECT_EQ(refusal(first), "No other contour waits");
  console.cell().hear(contour(4, ""));
  console.cell().hear(contour(9, ""));
  say(first, R"({"do":"take-contour"})");
  said = events();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].kind, EventMessage::Kind::kTakeContour);
  EXPECT_EQ(said[0].value, 9.0);

  say(first, R"({"do":"zoom","value":1.1})");
  EXPECT_EQ(refusal(first), "The zoom must be within [0, 1]");
  say(first, R"({"do":"zoom","value":0.75})");
  say(first, R"({"do":"refocus"})");
  said = events();
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0].kind, EventMessage::Kind::kSetZoom);
  EXPECT_EQ(said[0].value, 0.75);
  EXPECT_EQ(said[1].kind, EventMessage::Kind::kRefocus);
}

TEST_F(ConsoleTest, PagesLearnWhichContourWaitsAndWhereThePicturesLie) {
  console.cell().hear(contour(4, "a.png"));
  console.cell().hear(PreviewMessage{4, -0.01, 0.02, 0.03, 0.04, {1, 2, 3}});
  console.cell().hear(contour(9, "b.png"));
  nlohmann::json words;
  for (const auto& text : read(second))
    if (text["type"] == "words") words = text;
  EXPECT_EQ(words["contour"], 4);
  EXPECT_EQ(words["waiting"], 9);
  EXPECT_EQ(words["pictures"]["4"]["left_m"], -0.01);
  EXPECT_EQ(words["pictures"]["4"]["top_m"], 0.02);
  EXPECT_EQ(words["pictures"]["4"]["width_m"], 0.03);
  EXPECT_EQ(words["pictures"]["4"]["height_m"], 0.04);
  EXPECT_EQ(nlohmann::json::parse(console.contour_json(4))["source"], "a.png");
  EXPECT_EQ(nlohmann::json::parse(console.contour_json(9))["source"], "b.png");
  EXPECT_EQ(console.contour_json(5), R"({"id":0})");
}

TEST_F(ConsoleTest, ASlowPageGetsTheNewestStateAndNoQueue) {
  read(first);
  int states = 0;
  for (int n = 0; n < 250; ++n, pass(4)) {
    const auto message = console.next(first, now_ns);
    if (message && message->binary && message->bytes[0] == 1) ++states;
  }
  EXPECT_NEAR(states, 60, 4) << "of one second";
  pass(10'000);
  states = 0;
  for (int n = 0; n < 100; ++n) {
    const auto message = console.next(first, now_ns);
    if (message && message->binary && message->bytes[0] == 1) ++states;
  }
  EXPECT_EQ(states, 1);
  say(first, R"({"do":"rate","value":1})");
  states = 0;
  for (int n = 0; n < 250; ++n, pass(4)) {
    const auto message = console.next(first, now_ns);
    if (message && message->binary && message->bytes[0] == 1) ++states;
  }
  EXPECT_LE(states, 1) << "a hidden page";
}

TEST_F(ConsoleTest, StepsAreRareUntilSomethingIsToBeSaidOftenAndEachBringsAState) {
  EXPECT_EQ(console.pause_ns(), 16 * kMs);
  read(first);
  int states = 0;
  for (int n = 0; n < 60; ++n) {  // steps that come late and early
    pass(n % 2 ? 18 : 14);
    state.clear();
    read(first);
    states += state.empty() ? 0 : 1;
  }
  EXPECT_GE(states, 59);
  say(first, R"({"do":"rate","value":125})");
  EXPECT_EQ(console.pause_ns(), 8 * kMs);
  say(first, R"({"do":"rate","value":1})");
  EXPECT_EQ(console.pause_ns(), 16 * kMs) << "the other page has not said anything";
  pass(1000);
  say(first, R"({"do":"rate","value":60})");
  pass(20);
  state.clear();
  read(first);
  EXPECT_FALSE(state.empty()) << "a page that is seen again does not wait for its slow turn";
  say(first, R"({"do":"stop"})");
  EXPECT_EQ(console.pause_ns(), 8 * kMs) << "said every 20 ms until it is obeyed";
}

TEST_F(ConsoleTest, TheMastersAnswerSaysWhichFrameItActedOnAndHowFast) {
  take(first);
  read(first);
  move(first, 0);
  move(first, PageFrame::kHeld);
  const auto sent = hand();
  ASSERT_EQ(sent.size(), 2u);
  UdpHandAnswer answer;
  answer.session = lease;
  answer.sequence = sent[1].sequence;
  answer.flags = UdpHandAnswer::kHeld;
  answer.step_ns = now_ns + 2 * kMs;
  answer.x_m = 0.25;
  pass(8);
  console.hear(answer);
  read(first);
  EXPECT_EQ(field_of(state, page_field("held")), 1.0F);
  EXPECT_EQ(field_of(state, page_field("tool_x_m")), 0.25F);
  EXPECT_NEAR(field_of(state, page_field("step_s")), 2e-3, 1e-6);
}

TEST_F(ConsoleTest, AMasterThatDoesNotListenIsSaid) {
  take(first);
  const auto deaf = [&] {
    bool said = false;
    for (const auto& text : read(first))
      if (text["type"] == "words") said = text["deaf"];
    return said;
  };
  EXPECT_FALSE(deaf());
  for (int n = 0; n < 30; ++n, pass(20)) move(first, PageFrame::kHeld);
  EXPECT_TRUE(deaf());
  console.hear(UdpHandAnswer{});
  pass(100);
  EXPECT_FALSE(deaf());
}

}  // namespace
}  // namespace telekerf::master
