// SPDX-License-Identifier: Apache-2.0
// What the page shows of the cell, and the one sentence of what holds or hinders.
#include <gtest/gtest.h>

#include "common/codec/encoder.h"
#include "master/console/cell_view.h"
#include "master/modes.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

ContourMessage contour(std::uint32_t id) {
  ContourMessage message;
  message.id = id;
  return message;
}

class CellViewTest : public ::testing::Test {
 protected:
  void tell(MasterMode mode) {
    view.hear(
        TelemetryMessage{
            "master", 10, {{"mode", static_cast<double>(mode)}, {"beta", 0.5}, {"tool_x_m", 0.02}}},
        now_ns);
  }
  /// A command for this contour is heard.
  void work_on(std::uint32_t id) {
    Received<CommandBlock> command;
    command.value.contour_id = id;
    command.received_ns = now_ns;
    view.hear(command);
  }
  std::string sentence() const { return view.sentence("", now_ns); }

  CellView view;
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(CellViewTest, WhatIsInForceSeenAgainEndsTheWaitingOfAnother) {
  view.hear(contour(4));
  view.hear(contour(9));
  ASSERT_NE(view.waiting(), nullptr);
  view.hear(contour(4));
  EXPECT_EQ(view.waiting(), nullptr);
}

TEST_F(CellViewTest, DepthsAreOfTheContourThatIsWorkedOn) {
  ContourMessage line = contour(4);
  line.points_m = {{0.0, 0.0}, {0.01, 0.0}};
  view.hear(line);
  const auto before = view.depths().version();
  view.hear(contour(9));
  EXPECT_EQ(view.depths().version(), before) << "what waits is not cut";
}

TEST_F(CellViewTest, SaysWhatIsMissingOneAfterTheOther) {
  EXPECT_EQ(sentence(), "The master is not heard: is telekerf-master running in this cell?");
  tell(MasterMode::kIdle);
  EXPECT_EQ(sentence(), "No contour has come: is telekerf-vision running in this cell?");
  view.hear(contour(4));
  EXPECT_NE(sentence().find("cannot take this contour"), std::string::npos);
  tell(MasterMode::kApproach);
  EXPECT_EQ(sentence(), "Your tool moves to the contour");
  tell(MasterMode::kGuiding);
  EXPECT_NE(sentence().find("is telekerf-slave running?"), std::string::npos);
  tell(MasterMode::kEngaged);
  EXPECT_EQ(sentence(), "Engaged, but the slave has fallen silent");
  EXPECT_EQ(view.sentence("Stopped by operator", now_ns), "Stopped by operator");
  now_ns += 600 * kMs;
  EXPECT_EQ(sentence(), "The master has fallen silent: what you see is old");
  EXPECT_FALSE(view.engaged(now_ns));
}

TEST_F(CellViewTest, ShowsTheToolOnTheContourAsItWasPublished) {
  EXPECT_EQ(view.fields(now_ns)[page_field("master_age_s")], -1.0F);
  tell(MasterMode::kGuiding);
  now_ns += 30 * kMs;
  PageFields fields = view.fields(now_ns);
  EXPECT_FLOAT_EQ(fields[page_field("tool_x_m")], 0.01F);
  EXPECT_NEAR(fields[page_field("master_age_s")], 0.03, 1e-6);
  UdpHandAnswer answer;
  answer.x_m = 0.012;
  view.hear(answer);
  EXPECT_FLOAT_EQ(view.fields(now_ns)[page_field("tool_x_m")], 0.012F) << "newer than the telemetry";
  tell(MasterMode::kGuiding);
  EXPECT_FLOAT_EQ(view.fields(now_ns)[page_field("tool_x_m")], 0.01F);
}

TEST_F(CellViewTest, TheTelemetryOfOthersIsNotTheMasters) {
  view.hear(TelemetryMessage{"vision", 1, {{"mode", 3.0}}}, now_ns);
  EXPECT_EQ(view.fields(now_ns)[page_field("master_age_s")], -1.0F);
}

TEST_F(CellViewTest, AnotherContourWaitsUntilSomebodyWorksOnIt) {
  view.hear(contour(4));
  view.mark().add({0.01, 0.0});
  view.hear(contour(4));
  EXPECT_EQ(view.mark().size(), 1u) << "the same, published again";
  EXPECT_EQ(view.waiting(), nullptr);
  view.hear(contour(5));
  work_on(4);
  ASSERT_NE(view.waiting(), nullptr);
  EXPECT_EQ(view.waiting()->id, 5u);
  EXPECT_EQ(view.contour()->id, 4u);
  EXPECT_EQ(view.mark().size(), 1u);
  view.hear(contour(6));
  EXPECT_EQ(view.waiting()->id, 6u) << "of several the last one waits";
  EXPECT_EQ(view.contour(5), nullptr);
  EXPECT_EQ(view.contour(4)->id, 4u);
  EXPECT_EQ(view.contour(6)->id, 6u);
  work_on(6);
  EXPECT_EQ(view.contour()->id, 6u);
  EXPECT_EQ(view.waiting(), nullptr);
  EXPECT_EQ(view.mark().size(), 0u) << "another piece of work";
}

TEST_F(CellViewTest, WhoComesLateDoesNotTakeWhatWaitsForWhatIsWorkedOn) {
  view.hear(contour(5));  // the last that was published; the cell is at work on the one before
  work_on(0);
  EXPECT_EQ(view.contour()->id, 5u) << "nobody has taken any yet";
  work_on(4);
  EXPECT_FALSE(view.contour());
  ASSERT_NE(view.waiting(), nullptr);
  EXPECT_EQ(view.waiting()->id, 5u);
  view.hear(contour(6));
  work_on(4);
  EXPECT_FALSE(view.contour());
  EXPECT_EQ(view.waiting()->id, 6u);
  work_on(6);  // taken
  EXPECT_EQ(view.contour()->id, 6u);
  EXPECT_EQ(view.waiting(), nullptr);
  work_on(4);  // a block that was on its way
  EXPECT_EQ(view.contour()->id, 6u);
}

TEST_F(CellViewTest, EachContourHasThePictureThatItWasFoundIn) {
  const auto picture = [](std::uint32_t id, double left_m) {
    return PreviewMessage{id, left_m, 0.0, 1.0, 1.0, {}};
  };
  view.hear(picture(4, 0.1));
  EXPECT_EQ(view.pictures().size(), 1u) << "before its contour";
  view.hear(contour(4));
  view.hear(picture(4, 0.2));
  view.hear(contour(5));
  view.hear(picture(5, 0.3));
  ASSERT_EQ(view.pictures().size(), 2u);
  EXPECT_EQ(view.pictures().at(4).preview.left_m, 0.2);
  EXPECT_EQ(view.pictures().at(5).preview.left_m, 0.3);
  EXPECT_GT(view.pictures().at(5).number, view.pictures().at(4).number);
  view.hear(contour(6));
  view.hear(picture(6, 0.4));
  EXPECT_FALSE(view.pictures().contains(5));
  EXPECT_TRUE(view.pictures().contains(4));
}

TEST_F(CellViewTest, TheImagingUnitIsSaidWhileItIsHeard) {
  EXPECT_EQ(view.imaging_sentence(now_ns), "");
  view.hear(TelemetryMessage{"vision", 1, {{"frames", 3.0}}}, now_ns);
  EXPECT_EQ(view.imaging_sentence(now_ns), "") << "vision without one";
  view.hear(
      TelemetryMessage{
          "vision",
          2,
          {{"magnification", 2.5}, {"focus_mm", 1.25}, {"sharpness_tenengrad", 312.4}, {"zoom", 0.4}}},
      now_ns);
  EXPECT_EQ(view.imaging_sentence(now_ns), "searching the focus, 2.50x, focus 1.250 mm, sharpness 312");
  EXPECT_EQ(view.zoom(), 0.4);
  EXPECT_EQ(view.imaging_sentence(now_ns + 3100 * kMs), "") << "silent";
  const auto said = [&](double state, double gone) {
    view.hear(
        TelemetryMessage{
            "vision", 3, {{"magnification", 1.0}, {"imaging_state", state}, {"camera_gone", gone}}},
        now_ns);
    const std::string sentence = view.imaging_sentence(now_ns);
    return sentence.substr(0, sentence.find(", 1.00x"));
  };
  EXPECT_EQ(said(1, 0), "in focus");
  EXPECT_EQ(said(2, 0), "no focus found");
  EXPECT_EQ(said(3, 0), "focus moved by the printed law");
  EXPECT_EQ(said(1, 1), "camera or axes gone");
  EXPECT_EQ(said(9, 0), "state unknown");
}

TEST_F(CellViewTest, WhoPushesTheToolOffTheLineIsToldWhyTheBeamWaits) {
  StateBlock state;
  state.mode = SlaveMode::kFollowing;
  state.sample_period_ns = 1'000'000;
  codec::BlockEncoder encoder{codec::StreamSettings{}};
  const std::vector<Vec3> resting(16, Vec3::Zero());
  state.payload.size = static_cast<std::uint16_t>(encoder.encode(resting, 0, {}, state.payload.room()).value());
  view.hear({state, now_ns});
  const auto said = [&](double phi_m, double off_line) {
    const double engaged = static_cast<double>(MasterMode::kEngaged);
    view.hear(TelemetryMessage{"master", 1, {{"mode", engaged}, {"beta", 2.0}, {"phi_m", phi_m}, {"off_line", off_line}}},
              now_ns);
    return view.sentence("", now_ns);
  };
  // The guide is smoother than the contour: how far the tool is off it decides nothing.
  EXPECT_EQ(said(21e-6, 0.0), "Engaged: the slave follows");
  EXPECT_EQ(said(0.0, 1.0), "Engaged: you push the tool off the line, so the beam waits until it is back");
}

TEST_F(CellViewTest, NoBeamIsClaimedThatIsNotSeen) {
  EXPECT_EQ(view.beam_sentence(true, now_ns), "Beam: unknown, the slave is not heard");
  EXPECT_FALSE(view.laser_on(now_ns));
}

}  // namespace
}  // namespace telekerf::master
