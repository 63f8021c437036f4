// SPDX-License-Identifier: Apache-2.0
// What who drives sets from the page beside the motion: the command stream, the material and the depth.
#include "tests/unit/console/console_cell.h"

namespace telekerf::master {
namespace {

TEST_F(ConsoleTest, WhoDrivesChangesTheCommandStreamBetweenTwoEngagements) {
  const std::string local = R"({"do":"stream","text":"law local"})";
  say(second, local);
  EXPECT_EQ(refusal(second), "You watch: take the hand first");
  take(first);
  read(first);
  say(first, local);
  const auto said = events();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].kind, EventMessage::Kind::kSetStream);
  EXPECT_EQ(said[0].text, "law local") << "the master knows which laws there are";

  const auto tell = [&](double mode) {
    console.cell().hear(
        TelemetryMessage{
            "master",
            10,
            {{"mode", mode}, {"law", 2.0}, {"estimator", 1.0}, {"codec", 99.0}, {"block", 32.0}}},
        now_ns);
  };
  tell(3.0);
  say(first, local);
  EXPECT_EQ(refusal(first), "Law, estimator and codec change between two engagements: disengage first");
  tell(2.0);
  say(second, R"({"do":"stop"})");
  take(first);
  say(first, local);
  EXPECT_EQ(refusal(first), "Law, estimator and codec stay while everything is stopped");
  pass(100);
  nlohmann::json words;
  for (const auto& text : read(second))
    if (text["type"] == "words") words = text["stream"];
  EXPECT_EQ(words["law"], "local");
  EXPECT_EQ(words["estimator"], "delayed-innovation");
  EXPECT_TRUE(words["codec"].is_null()) << "of a newer master";
  EXPECT_EQ(words["block"], 32);
}

TEST_F(ConsoleTest, WhoDrivesChoosesMaterialAndDepthAndAllAreTold) {
  const std::string at_first = words(second)["depth"];
  EXPECT_TRUE(at_first.starts_with("Nobody has told this console what lies there, so this is for wood: wood gets ")) << at_first;
  say(second, R"({"do":"material","text":"fibreglass"})");
  EXPECT_EQ(refusal(second), "You watch: take the hand first");
  take(first);
  read(first);
  say(first, R"({"do":"material","text":"cheese"})");
  EXPECT_EQ(refusal(first), "No material of the name cheese is known");
  say(first, R"({"do":"depth","value":-0.001})");
  EXPECT_EQ(refusal(first), "The depth must be within [0, 100] mm; 0: none is wished");
  say(first, R"({"do":"material","text":"fibreglass"})");
  say(first, R"({"do":"depth","value":0.0001})");
  EXPECT_TRUE(events().empty()) << "the cell is told nothing";
  pass(100);
  const nlohmann::json told = words(second);
  EXPECT_EQ(told["material"], "fibreglass");
  EXPECT_EQ(told["depth_m"], 0.0001);
  const std::string depth = told["depth"];
  EXPECT_TRUE(depth.starts_with("fibreglass gets ")) << depth;
  EXPECT_NE(depth.find("mm/s on the workpiece for 0.10 mm"), std::string::npos) << depth;
}

TEST_F(ConsoleTest, TheThresholdIsTheOneThatVisionLooksWith) {
  pass(100);
  EXPECT_TRUE(words(first)["level"].is_null()) << "not heard yet";
  for (const double level : {0.4, 0.0}) {
    console.cell().hear(TelemetryMessage{"vision", 1, {{"level", level}}}, now_ns);
    pass(100);
    EXPECT_EQ(words(first)["level"], level);
  }
}

TEST_F(ConsoleTest, PagesGetTheDepthsAlongTheContourTwiceASecondAtMost) {
  ContourMessage line = contour(4, "a.png");
  line.points_m = {{0.0, 0.0}, {0.01, 0.0}};
  line.closed = false;
  console.cell().hear(line);
  read(first);
  const auto depths = [&] {
    int got = 0;
    for (int n = 0; n < 250; ++n, pass(4)) {
      const auto message = console.next(first, now_ns);
      if (!message || !message->binary || message->bytes[0] != 3) continue;
      ++got;
      EXPECT_EQ(message->bytes.size(), 8u + 4u * 40u) << "a quarter of a millimetre each";
    }
    return got;
  };
  EXPECT_LE(depths(), 1) << "once, and then nothing is new";
  EXPECT_EQ(depths(), 0);
  take(first);
  for (int n = 0; n < 20; ++n) say(first, R"({"do":"material","text":"wood"})");
  EXPECT_EQ(depths(), 1);
}

}  // namespace
}  // namespace telekerf::master
