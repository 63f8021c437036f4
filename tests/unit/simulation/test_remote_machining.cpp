// SPDX-License-Identifier: Apache-2.0
// What thesis 8.3 asks of a run, on runs whose speeds, button and depth are known.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "experiments/remote/remote_motion.h"

namespace telekerf::experiments {
namespace {

constexpr double kRadius_m = 5e-3, kBeta = 0.5;
constexpr int kTicks = 4000;

/// Once round a circle in 4 s: half of it at half the speed of the other half. The button is let go over the
/// last quarter of the ticks. The slave is the master x beta, `late` ticks later.
RunRecord circle(int late = 100) {
  RunRecord record;
  for (int i = 0; i < 720; ++i)
    record.contour_m.push_back(kRadius_m * Vec2(std::cos(i * M_PI / 360), std::sin(i * M_PI / 360)));
  record.master_figures["beta"] = kBeta;
  for (int i = 0; i < kTicks; ++i) {
    const double angle = 2 * M_PI * (i < 2000 ? i / 3000.0 : 2.0 / 3.0 + (i - 2000) / 6000.0);
    MasterRow row;
    row.tick = static_cast<std::uint64_t>(i);
    row.t_s = i * 1e-3;
    row.tool_m = kRadius_m / kBeta * Vec3(std::cos(angle), std::sin(angle), 0.0);
    row.joined = row.guided = row.engaged = true;
    row.button = i < 3000;
    row.beta = kBeta;
    record.master.push_back(row);
  }
  for (int i = 0; i < kTicks; ++i) {
    SlaveRow row;
    row.tick = static_cast<std::uint64_t>(i);
    row.t_s = i * 1e-3;
    if (i >= late) {
      const MasterRow& applied = record.master[static_cast<std::size_t>(i - late)];
      row.applied = i - late;
      row.tool_m = kBeta * applied.tool_m;
      row.laser_w = applied.button ? 4.0 : 0.0;
    }
    record.slave.push_back(row);
  }
  return record;
}

TEST(RemoteMachining, SpeedsAreAlongTheContourAndThoseOfTheTickThatWasApplied) {
  const auto motion = remote_motion(circle());
  ASSERT_GT(motion.size(), 300u);
  const double fast = 2 * M_PI / 3.0 * kRadius_m;  // rad/s on the first half
  EXPECT_NEAR(motion[50].slave_m_per_s, fast, 1e-3 * fast);
  EXPECT_NEAR(motion[50].rescaled_m_per_s, fast / kBeta, 1e-3 * fast);
  EXPECT_NEAR(motion[50].master_m_per_s, motion[50].rescaled_m_per_s, 1e-9);
  EXPECT_NEAR(motion.back().slave_m_per_s, 0.5 * fast, 1e-3 * fast);
  EXPECT_LT((motion[50].rescaled_m - motion[50].master_m).norm(), 1e-12);
  const auto speeds = speed_json(motion);
  EXPECT_NEAR(speeds["rescaled_minus_master_mm_s"]["max"].get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(speeds["slave_mm_s"]["max"].get<double>(), 1e3 * fast, 0.1);
}

TEST(RemoteMachining, TheMotionIsLeftTickByTick) {
  const RunRecord record = circle();
  std::istringstream in(motion_csv(record));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  // All but those before the first applied tick and the ends of the differences.
  ASSERT_GT(lines.size(), static_cast<std::size_t>(kTicks - 100 - 30));
  EXPECT_TRUE(lines[0].starts_with("time_s,master_x_m,")) << lines[0];
  const double first_s = std::stod(lines[1]), second_s = std::stod(lines[2]);
  EXPECT_NEAR(second_s - first_s, 1e-3, 1e-9);
  EXPECT_TRUE(lines[1].ends_with(",1")) << "lit: " << lines[1];
  EXPECT_TRUE(lines.back().ends_with(",0")) << "the button was let go: " << lines.back();
}

TEST(RemoteMachining, TheScaleIsThatOfTheMotionsNotTheOneThatWasAsked) {
  RunRecord record = circle();
  EXPECT_NEAR(measured_beta(remote_motion(record)).get<double>(), kBeta, 1e-9);
  for (SlaveRow& row : record.slave) row.tool_m = 1.1 * row.tool_m + Vec3(1e-3, 0.0, 0.0);
  EXPECT_NEAR(measured_beta(remote_motion(record)).get<double>(), 1.1 * kBeta, 1e-9);
  EXPECT_TRUE(measured_beta({}).is_null());
}

TEST(RemoteMachining, ASlaveThatIsNotWhereTheMasterWasShowsInTheSpeeds) {
  RunRecord record = circle();
  for (std::size_t i = 1000; i < 2000; ++i)
    record.slave[i].tool_m *= 1.0 + 0.2 * std::sin(0.01 * static_cast<double>(i));
  EXPECT_GT(speed_json(remote_motion(record))["rescaled_minus_master_mm_s"]["max"].get<double>(), 0.1);
}

TEST(RemoteMachining, LightWithoutTheButtonIsCounted) {
  RunRecord record = circle();
  auto button = button_json(record);
  EXPECT_EQ(button["beam_ticks"], 3000);
  EXPECT_EQ(button["beam_ticks_without_button"], 0);
  EXPECT_NEAR(button["button_share"].get<double>(), 0.75, 1e-12);
  record.slave[3500].laser_w = 1.0;
  record.slave[50].laser_w = 1.0;  // nothing is applied yet
  button = button_json(record);
  EXPECT_EQ(button["beam_ticks_without_button"], 2);
}

TEST(RemoteMachining, DepthIsMadeByTheTimeThatTheOperatorTookWithTheButtonHeld) {
  const RemoteMark mark = burn_record(circle(), workpiece::kWood, BeamPower::kConstant, 10.0);
  const auto at = [&](double share) {
    return static_cast<std::size_t>(share * static_cast<double>(mark.depth_m.size()));
  };
  EXPECT_GT(mark.depth_m[at(0.3)], 0.0);
  EXPECT_NEAR(mark.depth_m[at(0.75)] / mark.depth_m[at(0.3)], 2.0, 0.1) << "half the speed, twice the depth";
  EXPECT_EQ(mark.depth_m[at(0.95)], 0.0) << "without the button there is none";
  const auto json = mark_json(mark);
  EXPECT_GT(json["correlation_with_dwell"].get<double>(), 0.98);
  EXPECT_NEAR(json["marked_share"].get<double>(), 5.0 / 6.0, 0.05);
  EXPECT_EQ(json["unlit_max_mm"].get<double>(), 0.0);
  const RemoteMark recorded = burn_record(circle(), workpiece::kWood, BeamPower::kRecorded, 10.0);
  EXPECT_NEAR(recorded.depth_m[at(0.3)] / mark.depth_m[at(0.3)], 0.4, 0.02) << "4 W instead of 10";
}

TEST(RemoteMachining, WhatWasNeverLitHasNoFigures) {
  RunRecord record = circle();
  for (SlaveRow& row : record.slave) row.laser_w = 0.0;
  EXPECT_TRUE(mark_json(burn_record(record, workpiece::kWood, BeamPower::kConstant, 10.0)).is_null());
  record.slave.clear();
  EXPECT_TRUE(speed_json(remote_motion(record)).is_null());
}

}  // namespace
}  // namespace telekerf::experiments
