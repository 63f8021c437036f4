// SPDX-License-Identifier: Apache-2.0
// The measures of a run, on runs whose errors are known by construction.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "common/reporting/run_lookup.h"
#include "common/recording/run_folder.h"
#include "common/reporting/run_report.h"
#include "common/runtime/startup_error.h"
#include "tests/unit/reporting/circle_run.h"

namespace telekerf::reporting {
namespace {

TEST(RunReport, ARoundTripThatWasNeverMeasuredIsUnknownNotZero) {
  RunRecord record = circle_run(0.0, 0.0);
  record.master_figures["block_ms"] = 16.0;
  record.slave_figures["playout_ms"] = 2.0;
  EXPECT_TRUE(make_report(record)["link"]["rtt_ms"]["p50"].is_null());
  EXPECT_TRUE(make_report(record)["link"]["total_ms"].is_null());
  record.master_figures["rtt_p50_ms"] = 100.0;
  EXPECT_EQ(make_report(record)["link"]["total_ms"].get<double>(), 118.0);
}

TEST(RunReport, TheControlPeriodIsWhatTheSlaveSaysOrTheTimeBetweenItsRows) {
  RunRecord record;
  EXPECT_EQ(control_period_s(record), 0.0);
  record.slave.resize(1);
  EXPECT_EQ(control_period_s(record), 0.0);
  record.slave.resize(2);
  record.slave[1].t_s = 0.25;
  EXPECT_EQ(control_period_s(record), 0.25);
  record.slave.resize(3);
  record.slave[2].t_s = 1.0;
  EXPECT_EQ(control_period_s(record), 0.5);
  record.slave_figures["control_period_s"] = 0.125;
  EXPECT_EQ(control_period_s(record), 0.125);
}

TEST(RunReport, ABetaThatChangesInMidRunChangesNoFigureAtTheWorkpiece) {
  RunRecord record = circle_run(100e-6, 30e-6);
  for (std::size_t i = 400; i < record.master.size(); ++i) {
    record.master[i].beta = 1.0;
    for (double& at : record.master[i].tool_m) at *= 0.5;
  }
  const auto report = make_report(record);
  EXPECT_NEAR(report["tracking"]["rms_um"].get<double>(), 30.0, 0.01);
  EXPECT_NEAR(report["cut"]["rms_um"].get<double>(), 80.0, 0.1);
  EXPECT_NEAR(report["constraint"]["max_um"].get<double>(), 100.0, 0.1) << "at beta 0.5";
  EXPECT_LT(report["constraint"]["rms_um"].get<double>(), 90.0) << "at beta 1 the same motion is 50 um off";
}

TEST(RunReport, MeasuresConstraintTrackingAndCutWithoutAnyFittedShift) {
  const auto report = make_report(circle_run(100e-6, 30e-6));
  EXPECT_NEAR(report["constraint"]["rms_um"].get<double>(), 100.0, 0.1);
  EXPECT_NEAR(report["constraint"]["max_um"].get<double>(), 100.0, 0.1);
  EXPECT_NEAR(report["tracking"]["rms_um"].get<double>(), 30.0, 0.01);
  EXPECT_NEAR(report["prediction"]["rmse_um"].get<double>(), 7.0, 0.01)
      << "slave to what was predicted of it";
  EXPECT_NEAR(report["cut"]["rms_um"].get<double>(), 80.0, 0.1);
  EXPECT_NEAR(report["cut"]["coverage"].get<double>(), 0.5, 0.005);
  EXPECT_NEAR(report["cut"]["laser_on_s"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(report["cut"]["energy_inside_j"].get<double>(), 2.0, 1e-6);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_NEAR(report["contour"]["length_m"].get<double>(), 0.02 * M_PI, 1e-6);
}

TEST(RunReport, TheForceIsHeldAgainstTheSlavesOfTheSameTick) {
  const auto report = make_report(circle_run(0.0, 0.0));
  EXPECT_EQ(report["force"]["samples"].get<int>(), 900);
  EXPECT_NEAR(report["force"]["max_n"].get<double>(), 0.939, 1e-9);
  EXPECT_NEAR(report["force"]["coding_max_n"].get<double>(), 0.01, 1e-9);
  EXPECT_NEAR(report["force"]["coding_rms_n"].get<double>(), 0.01 / std::sqrt(3.0), 1e-9);
}

TEST(RunReport, ForcesOfTicksThatTheSlaveHasNotRecordedDoNotCount) {
  RunRecord record = circle_run(0.0, 0.0);  // the slave's ticks are 40 to 1039
  for (MasterRow& row : record.master) row.force_tick = -1.0;
  const auto samples = [&] { return make_report(record)["force"]["samples"].get<int>(); };
  EXPECT_EQ(samples(), 0);
  for (const auto& [tick, counts] :
       {std::pair{39.0, false}, {40.0, true}, {1039.0, true}, {1040.0, false}, {1e9, false}}) {
    record.master[0].force_tick = tick;
    EXPECT_EQ(samples(), counts ? 1 : 0) << tick;
  }
}

TEST(RunReport, TheVerdictIsBadOnceTheLaserLeavesTheCorridor) {
  EXPECT_TRUE(stayed_inside(make_report(circle_run(0.0, 0.4e-3))));
  RunRecord record = circle_run(0.0, 0.0);
  for (double& at : record.slave[200].tool_m) at *= 1.1;
  EXPECT_FALSE(stayed_inside(make_report(record)));
}

TEST(RunReport, EnergyBeyondTheCorridorIsCountedAndReachesNothing) {
  const auto report = make_report(circle_run(0.0, 0.6e-3));
  EXPECT_EQ(report["cut"]["energy_inside_j"].get<double>(), 0.0);
  EXPECT_NEAR(report["cut"]["energy_outside_corridor_j"].get<double>(), 2.0, 1e-6);
  EXPECT_EQ(report["cut"]["coverage"].get<double>(), 0.0);
  EXPECT_FALSE(succeeded(report));
  EXPECT_TRUE(succeeded(make_report(circle_run(0.0, 0.0))));
  RunRecord dark = circle_run(0.0, 0.0);
  for (SlaveRow& row : dark.slave) row.laser_w = 0.0;
  EXPECT_TRUE(stayed_inside(make_report(dark)));
  EXPECT_FALSE(succeeded(make_report(dark))) << "a run that cuts nothing is no success";
}

TEST(RunReport, EachCutIsJudgedByTheContourThatWasInForce) {
  RunRecord record = circle_run(0.0, 0.0);
  record.earlier.push_back({750, true, record.contour_m});
  for (Vec2& point : record.contour_m) point *= 1.5;  // from master tick 750 on
  const auto report = make_report(record);
  EXPECT_NEAR(report["cut"]["energy_inside_j"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(report["cut"]["energy_outside_corridor_j"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(report["cut"]["coverage"].get<double>(), 0.0) << "of the last one";
  EXPECT_EQ(report["contour"]["earlier"].get<int>(), 1);
  record.earlier.front().until_tick = 1500;
  EXPECT_EQ(make_report(record)["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
}

TEST(RunReport, TicksThatAreNotSettledOrNotAppliedAreNotTracking) {
  RunRecord record = circle_run(0.0, 20e-6);
  for (std::size_t i = 0; i < 500; ++i) {
    record.slave[i].tool_m[0] += 0.005;
    (i % 2 == 0 ? record.slave[i].settled = false : record.slave[i].applied = -1.0);
  }
  const auto report = make_report(record);
  EXPECT_NEAR(report["tracking"]["max_um"].get<double>(), 20.0, 0.01);
  EXPECT_EQ(report["tracking"]["samples"].get<int>(), 500);
}

TEST(RunReport, ARunWithoutMotionHasNoErrorsRatherThanZeroErrors) {
  RunRecord record = circle_run(0.0, 0.0);
  record.master.clear();
  record.slave.clear();
  const auto report = make_report(record);
  EXPECT_TRUE(report["tracking"]["rms_um"].is_null());
  EXPECT_TRUE(report["constraint"]["rms_um"].is_null());
  EXPECT_EQ(report["cut"]["coverage"].get<double>(), 0.0);
}

TEST(RunReport, TheCorridorIsHalfAMillimetreAndItsEdgeBelongsToIt) {
  EXPECT_EQ(make_report(circle_run(0.0, 0.499e-3))["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_GT(make_report(circle_run(0.0, 0.501e-3))["cut"]["energy_outside_corridor_j"].get<double>(), 1.9);
  EXPECT_EQ(make_report(circle_run(0.0, -0.499e-3))["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_GT(make_report(circle_run(0.0, -0.501e-3))["cut"]["energy_outside_corridor_j"].get<double>(), 1.9);
}

TEST(RunReport, CoverageIsOfWhatWasPassedWithTheLaserOnOnceHoweverOften) {
  const auto coverage = [](auto lit) {
    RunRecord record = circle_run(0.0, 0.0);
    for (std::size_t i = 0; i < record.slave.size(); ++i) record.slave[i].laser_w = lit(i) ? 4.0 : 0.0;
    return make_report(record)["cut"]["coverage"].get<double>();
  };
  EXPECT_NEAR(coverage([](std::size_t) { return true; }), 0.9995, 0.0005) << "but for the last tick's way";
  EXPECT_NEAR(coverage([](std::size_t i) { return i < 250; }), 0.25, 0.003);
  EXPECT_NEAR(coverage([](std::size_t i) { return i < 125 || i > 875; }), 0.25, 0.004) << "round the seam";
  // Lit at every tenth tick: only where it stood.
  EXPECT_NEAR(coverage([](std::size_t i) { return i % 10 == 0; }), 0.1, 0.03);
  // A jump across: what lies between was not burnt.
  RunRecord jump = circle_run(0.0, 0.0);
  for (std::size_t i = 100; i < jump.slave.size(); ++i)
    jump.slave[i].tool_m = jump.slave[i < 200 ? 600 + i : 99].tool_m;
  EXPECT_NEAR(make_report(jump)["cut"]["coverage"].get<double>(), 0.2, 0.004);
}

TEST(RunReport, TheMastersToolIsTakenBetweenItsTicks) {
  RunRecord record = circle_run(0.0, 0.0);
  for (SlaveRow& row : record.slave) row.applied += 0.5;
  // The tool is half a tick of its way, 31.4 um, behind; of the last one there is no master's.
  const auto report = make_report(record);
  EXPECT_EQ(report["tracking"]["samples"].get<int>(), 999);
  EXPECT_NEAR(report["tracking"]["rms_um"].get<double>(), 31.4, 0.1);
  record.master[300].joined = false;
  record.master[301].joined = false;
  EXPECT_EQ(make_report(record)["tracking"]["settled"]["samples"].get<int>(), 997);
  for (SlaveRow& row : record.slave) row.applied -= 1.0;
  EXPECT_EQ(make_report(record)["tracking"]["samples"].get<int>(), 999) << "nor of one before the first";
}

// 100 ticks of the first approach, 100 that follow; then the slave applies nothing for 50, comes back over 30
// from 1 mm off, beam still on for one of them; the rest follows.
TEST(RunReport, EveryAppliedTickFromTheEndOfTheFirstApproachCounts) {
  RunRecord record = circle_run(0.0, 20e-6);
  const auto off = [&](std::size_t from, std::size_t to, double off_m) {
    for (std::size_t i = from; i < to; ++i) {
      record.slave[i].tool_m.z() += off_m;
      record.slave[i].settled = false;
      record.slave[i].laser_w = 0.0;
    }
  };
  off(0, 100, 5e-3);
  off(250, 280, 1e-3);
  record.slave[279].laser_w = 4.0;
  for (std::size_t i = 200; i < 250; ++i) record.slave[i].applied = -1.0;
  const auto report = make_report(record);
  const auto& tracking = report["tracking"];
  EXPECT_EQ(tracking["samples"].get<int>(), 850);
  EXPECT_NEAR(tracking["max_um"].get<double>(), std::hypot(1000.0, 20.0), 0.01);
  EXPECT_NEAR(tracking["rms_um"].get<double>(), std::sqrt(30.0 / 850.0 * 1e6 + 20.0 * 20.0), 0.01);
  EXPECT_EQ(tracking["settled"]["samples"].get<int>(), 820);
  EXPECT_EQ(tracking["settled"]["left_out"].get<int>(), 30);
  EXPECT_NEAR(tracking["settled"]["max_um"].get<double>(), 20.0, 0.01);
  EXPECT_EQ(tracking["laser_on"]["samples"].get<int>(), 100 + 1 + 220);
  EXPECT_NEAR(tracking["laser_on"]["max_um"].get<double>(), std::hypot(1000.0, 20.0), 0.01);
  EXPECT_EQ(report["prediction"]["samples"].get<int>(), 850);
  EXPECT_EQ(report["prediction"]["settled"]["left_out"].get<int>(), 30);
  EXPECT_NEAR(report["prediction"]["settled"]["max_um"].get<double>(), 7.0, 0.01);
}

TEST(RunReport, OnlyWhatIsGuidedCountsForTheConstraint) {
  RunRecord record = circle_run(50e-6, 0.0);
  for (std::size_t i = 0; i < 400; ++i) {
    record.master[i].guided = false;
    record.master[i].tool_m *= 1.5;
  }
  EXPECT_EQ(make_report(record)["constraint"]["samples"].get<int>(), 600);
  EXPECT_NEAR(make_report(record)["constraint"]["max_um"].get<double>(), 50.0, 0.1);
}

TEST(RunReport, FiguresOfBothSitesAreAddedWhereBothCount) {
  RunRecord record = circle_run(0.0, 0.0);
  record.master_figures = {{"lost", 3},         {"refused", 5},       {"overruns", 7},  {"rtt_p50_ms", 1.5},
                           {"rtt_p95_ms", 2.5}, {"rtt_p99_ms", 3.5},  {"block_ms", 16}, {"seed", 9},
                           {"redundancy", 2},   {"copies_mean", 2.5}, {"copies_max", 6}};
  record.slave_figures = {
      {"lost", 20}, {"refused", 40}, {"overruns", 70}, {"playout_ms", 4}, {"control_period_s", 2e-3}};
  record.contour_closed = false;
  record.words = {{"law", "anchored"}, {"netem", "x"}, {"codec", "sdct"}, {"image", "heart"}};
  const auto report = make_report(record);
  EXPECT_EQ(report["link"]["lost"].get<int>(), 23);
  EXPECT_EQ(report["link"]["refused"].get<int>(), 45);
  EXPECT_EQ(report["link"]["rtt_ms"]["p95"].get<double>(), 2.5);
  EXPECT_EQ(report["link"]["rtt_ms"]["p99"].get<double>(), 3.5);
  EXPECT_EQ(report["link"]["total_ms"].get<double>(), 21.5);
  EXPECT_EQ(report["loop"]["master"]["overruns"].get<int>(), 7);
  EXPECT_EQ(report["loop"]["slave"]["overruns"].get<int>(), 70);
  EXPECT_EQ(report["seed"].get<int>(), 9);
  EXPECT_EQ(report["codec"]["redundancy"].get<int>(), 2);
  EXPECT_EQ(report["codec"]["copies"]["mean"].get<double>(), 2.5);
  EXPECT_EQ(report["codec"]["copies"]["max"].get<int>(), 6);
  EXPECT_EQ(report["law"], "anchored");
  EXPECT_EQ(report["netem"], "x");
  EXPECT_EQ(report["contour"]["image"], "heart");
  EXPECT_EQ(report["contour"]["points"].get<int>(), 3600);
  EXPECT_FALSE(report["contour"]["closed"].get<bool>());
  EXPECT_NEAR(report["cut"]["laser_on_s"].get<double>(), 1.0, 1e-9) << "by the period that the slave tells";
  record.contour_m.resize(1);
  EXPECT_THROW((void)make_report(record), StartupError);
}

TEST(RunRecord, WhatIsWrittenIsReadAgainBitForBit) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "run_record";
  RunRecord record = circle_run(1.0 / 3e4, 1e-7 / 3);
  record.slave_figures["lost"] = 3;
  record.words["law"] = "local";
  write_contour(folder, record);
  write_master(folder, record);
  write_slave(folder, record);
  EXPECT_EQ(make_report(read_run(folder)).dump(), make_report(record).dump());
  write_report(folder, record);
  EXPECT_TRUE(std::filesystem::exists(folder / "cut.png"));
  std::ifstream trace(folder / "trace.csv");
  std::string header;
  std::getline(trace, header);
  EXPECT_EQ(
      header,
      "t_s,master_x_m,master_y_m,master_z_m,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w,"
      "force_x_n,force_y_n,force_z_n,applied_tick,beta,predicted_x_m,predicted_y_m,predicted_z_m,settled");
  std::string row;
  std::getline(trace, row);
  EXPECT_TRUE(row.starts_with("0.000000,")) << "from the slave's first tick: " << row;
  EXPECT_NE(row.find(",500,0.5,"), std::string::npos) << row;
  EXPECT_TRUE(row.ends_with(",1")) << row;
  record.slave[1].applied = -1.0;
  write_report(folder, record);
  std::ifstream again(folder / "trace.csv");
  for (int line = 0; line < 3; ++line) std::getline(again, row);
  EXPECT_TRUE(row.starts_with("0.001000,,,,")) << "nothing is known of the master: " << row;
  EXPECT_TRUE(row.ends_with(",,,,,0")) << row;
}

TEST(RunRecord, ADamagedFileIsRefusedByNameAndLine) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "run_damaged";
  const RunRecord record = circle_run(0, 0);
  write_contour(folder, record);
  write_master(folder, record);
  write_slave(folder, record);
  std::ofstream(folder / "slave.csv", std::ios::app) << "1,2,three\n";
  try {
    (void)read_run(folder);
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("slave.csv: line 1002"), std::string::npos) << refusal.what();
  }
  EXPECT_THROW((void)read_run(folder / "nowhere"), StartupError);
}

}  // namespace
}  // namespace telekerf::reporting
