// SPDX-License-Identifier: Apache-2.0
// The station of automatic machining in virtual time: settings, what it refuses, a job to its end or to a
// stop, and all that the work leaves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "slave/machining/station.h"
#include "tests/unit/machining/work.h"

namespace telekerf::machining {
namespace {

TEST(MachiningSettings, HaveTheseDefaultsAndBounds) {
  StationSettings station;
  Settings settings;
  station.add_parameters(settings);
  struct Row {
    const char* name;
    double min;
    double max;
  };
  constexpr Row kBounds[] = {{"laser_w", 0, 1000},       {"laser_max_w", 0, 1000},
                             {"mismatch", 0, 0.5},       {"speed_mm_s", 0.1, 100},
                             {"kerf_um", 0, 2000},       {"machining_hz", 800, 10000},
                             {"dose_max_j", 0.01, 1000}, {"dose_max_j_per_mm2", 0.1, 1000}};
  const auto declared = settings.declared();
  const auto find = [&](const std::string& name) {
    return std::find_if(declared.begin(), declared.end(), [&](const Setting& s) { return s.name == name; });
  };
  for (const Row& row : kBounds) {
    ASSERT_NE(find(row.name), declared.end()) << row.name;
    EXPECT_EQ(find(row.name)->bounds.min, row.min) << row.name;
    EXPECT_EQ(find(row.name)->bounds.max, row.max) << row.name;
  }
  for (const char* name :
       {"robot", "drive", "laser", "seed", "sensor", "controller", "corner", "material", "no_framing"})
    EXPECT_NE(find(name), declared.end()) << name;
  EXPECT_EQ(station.laser_w, 10.0);
  EXPECT_EQ(station.speed_mm_s, 8.0);
  EXPECT_EQ(station.machining_hz, 2400.0);
  EXPECT_EQ(station.mismatch, 0.1);
  EXPECT_EQ(station.seed, 1u);
  EXPECT_EQ(station.kerf_um, 0.0);
  EXPECT_FALSE(station.no_framing);
}

TEST(MachiningStation, PreparesEveryLineOfTheContourAsItsSettingsSay) {
  ContourMessage message = square(4e-3);
  message.further.push_back({true, square(2e-3).points_m});
  StationSettings settings;
  settings.kerf_um = 100.0;
  settings.machining_hz = 1200.0;
  settings.corner = CornerPolicy::kExact;
  for (const bool no_framing : {true, false}) {
    settings.no_framing = no_framing;
    const auto job = Station(settings).prepare(message);
    ASSERT_EQ(job->order, (std::vector<std::size_t>{1, 0}));
    EXPECT_NEAR(geometry::bounding_box(job->lines[0].points_m).size().x(), 1.9e-3, 1e-6) << "the hole";
    EXPECT_NEAR(geometry::bounding_box(job->lines[1].points_m).size().x(), 4.1e-3, 1e-6);
    EXPECT_EQ(job->period_s, 1.0 / 1200.0);
    EXPECT_NEAR(job->plans[0].mean_speed_m_per_s, 8e-3, 1e-5);
    EXPECT_LT(job->plans[0].path.smoothing_m(), 13e-6) << "corners are exact";
    EXPECT_EQ(std::count(job->phases.begin(), job->phases.end(), JobPhase::kFraming) > 0, !no_framing);
  }
}

TEST(MachiningStation, PlansWithHalfOfItsRobotsAcceleration) {
  StationSettings settings = quick();
  settings.robot = "master-horizontal";  // 10 m/s^2
  settings.speed_mm_s = 100.0;
  const auto job = Station(settings).prepare(square(5e-3));
  double most_m_per_s2 = 0.0;
  for (std::size_t i = 0; i < job->trajectory.size(); ++i)
    most_m_per_s2 = std::max(most_m_per_s2, job->trajectory[i].acceleration_m_per_s2.norm());
  EXPECT_LT(most_m_per_s2, 5.0 * 1.05);
  EXPECT_GT(most_m_per_s2, 3.5) << "and uses it";
}

TEST(MachiningStation, WhatCannotBeMachinedOrReachedIsRefused) {
  const Station station(quick());
  EXPECT_EQ(refusal_of([&] {
              (void)station.prepare(square(50e-6));
            }).find("the contour cannot be machined: contour 0: the contour is 0.05 mm across"),
            0u);
  const double reach_m = robot::load_robot("slave-keops").workspace.radius_m;
  // With its corners beyond, and an open line whose run-out ends 0.1 mm within or beyond: the edge counts.
  const std::string refusal = refusal_of([&] { (void)station.prepare(square(2.0 * reach_m)); });
  EXPECT_NE(refusal.find("mm from the workspace's centre, but slave-keops reaches "), std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find(fmt::format("reaches {:.1f} mm; use a smaller --width-mm", 1e3 * reach_m)),
            std::string::npos)
      << refusal;
  const double run_out_m = 0.02 * 0.02 / 4.0 + 1.5 * 0.02 * 0.012 + 2e-3;
  for (const double short_of_m : {0.1e-3, -0.1e-3}) {
    ContourMessage line;
    line.closed = false;
    line.points_m = {{0.0, 0.0}, {reach_m - run_out_m - short_of_m, 0.0}};
    const std::string said = refusal_of([&] { (void)station.prepare(line); });
    EXPECT_EQ(said == "accepted", short_of_m > 0.0) << said;
    if (short_of_m < 0.0) {
      EXPECT_EQ(said, fmt::format("the work reaches {0:.1f} mm from the workspace's centre, but slave-keops "
                                  "reaches {0:.1f} mm; use a smaller --width-mm",
                                  1e3 * reach_m))
          << "where it first leaves";
    }
  }
}

int count_lines(const fs::path& file) {
  std::ifstream in(file);
  return static_cast<int>(std::count(std::istreambuf_iterator<char>(in), {}, '\n'));
}

TEST_F(MachiningAtWork, AJobIsWorkedOffToItsEndAndLeavesItsFigures) {
  EXPECT_FALSE(station_.ended());
  work();
  EXPECT_TRUE(station_.finished());
  EXPECT_EQ(steps_, static_cast<int>(job_->trajectory.size()));
  EXPECT_EQ(station_.time_s(), job_->time_s());
  station_.release();
  LoopStatistics loop;
  loop.steps = 1200;
  loop.rate_hz = 2400.0;
  loop.overruns = 3;
  const auto result = station_.report(folder_, loop);
  EXPECT_EQ(result["finished"], true);
  EXPECT_EQ(result["controller"], "auto");
  EXPECT_EQ(result["corner"], "rounded");
  EXPECT_EQ(result["drive"]["name"], "simulated");
  EXPECT_EQ(result["drive"]["tool"], "true");
  EXPECT_EQ(result["sensor"], "hall");
  EXPECT_EQ(result["contours"], 1);
  EXPECT_EQ(result["contours_cut"], 1);
  EXPECT_EQ(result["order"], nlohmann::json::array({0}));
  EXPECT_NEAR(result["length_mm"].get<double>(), 1e3 * job_->plans[0].path.length_m(), 1e-9);
  EXPECT_EQ(result["limit_violations"], 0);
  EXPECT_NEAR(result["time_s"].get<double>(), steps_ / 2400.0, 1e-12);
  EXPECT_NEAR(result["time_estimate_s"].get<double>(), job_->time_s(), 1e-12);
  EXPECT_EQ(result["tangential_speed"]["commanded_mm_s"], 20.0);
  EXPECT_NEAR(result["tangential_speed"]["slowest_planned_mm_s"].get<double>(),
              1e3 * job_->plans[0].slowest_m_per_s, 1e-9);
  EXPECT_NEAR(result["tangential_speed"]["mean_mm_s"].get<double>(), 1e3 * job_->plans[0].mean_speed_m_per_s,
              0.1);
  EXPECT_EQ(result["corners"], 4);
  EXPECT_NEAR(result["corner_error_um"].get<double>(), 9.22, 0.2);
  EXPECT_LT(result["contour_error_um"]["max"].get<double>(), 8.0);
  EXPECT_LT(result["closure_gap_um"].get<double>(), 0.5);
  EXPECT_NEAR(result["normal_error_um"]["rms"].get<double>(), 0.43, 0.05);
  EXPECT_NEAR(result["tangential_error_um"]["rms"].get<double>(), 2.4, 0.3);
  EXPECT_NEAR(result["height_error_um"]["rms"].get<double>(), 0.23, 0.05);
  const auto& burn = result["burn"];
  EXPECT_EQ(burn["material"], "wood");
  EXPECT_NEAR(burn["energy_inside_j"].get<double>(), energy_j_, 0.01);
  EXPECT_EQ(burn["energy_outside_corridor_j"], 0.0);
  EXPECT_NEAR(burn["absorbed_j"].get<double>(), 0.7 * energy_j_, 0.007);
  EXPECT_NEAR(burn["depth_um"].get<double>(), 152.5, 3.0);
  EXPECT_NEAR(burn["kerf_um"].get<double>(), 37.7, 1.5);
  EXPECT_NEAR(burn["depth_variation_percent"].get<double>(), 2.8, 0.3);
  EXPECT_EQ(count_lines(folder_ / "trace.csv"), 1 + steps_);
  // Half a millimetre of corridor round 1.5 mm, 7.5 um a pixel, and the bar.
  const cv::Mat mark = cv::imread((folder_ / "mark.png").string());
  EXPECT_NEAR(mark.cols, 2.5e-3 / 7.5e-6, 2);
  EXPECT_EQ(mark.rows, mark.cols + 60);
  EXPECT_FALSE(cv::imread((folder_ / "depth.png").string()).empty());
  std::ifstream timing_file(folder_ / "timing.json");
  const auto timing = nlohmann::json::parse(timing_file);
  EXPECT_EQ(timing["time_s"], 0.5);
  EXPECT_EQ(timing["rate_hz"], 2400.0);
  EXPECT_EQ(timing["overruns"], 3);
  EXPECT_EQ(timing["readings_missed"], 0);
  EXPECT_EQ(timing["laser_clipped"], 0);
  EXPECT_EQ(timing["laser_untold"], 0);
  std::ifstream result_file(folder_ / "result.json");
  EXPECT_EQ(nlohmann::ordered_json::parse(result_file), result);
}

TEST_F(MachiningAtWork, TheTraceTellsEveryStepInOrder) {
  work();
  (void)station_.report(folder_, {.rate_hz = 2400.0});
  std::ifstream trace(folder_ / "trace.csv");
  std::string header;
  std::getline(trace, header);
  EXPECT_EQ(header, "t_s,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w");
  std::string line;
  for (std::size_t n = 0; std::getline(trace, line); ++n) {
    double t_s = 0, x_m = 0, y_m = 0, tool_x_m = 0, tool_y_m = 0, tool_z_m = 0, laser_w = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &t_s, &x_m, &y_m, &tool_x_m, &tool_y_m,
                          &tool_z_m, &laser_w),
              7);
    ASSERT_NEAR(t_s, static_cast<double>(n) / 2400.0, 1e-7);
    ASSERT_NEAR(x_m, job_->trajectory[n].position_m.x(), 1e-12);
    ASSERT_NEAR(y_m, job_->trajectory[n].position_m.y(), 1e-12);
    ASSERT_LT(std::hypot(tool_x_m - x_m, tool_y_m - y_m), 60e-6) << n;
    ASSERT_LT(std::abs(tool_z_m), 30e-6) << n;
    ASSERT_TRUE(laser_w >= 0.0 && laser_w <= 15.0);
    ASSERT_TRUE(laser_w == 0.0 || job_->trajectory[n].beam);
  }
}

TEST_F(MachiningAtWork, AStopIsHeldForATenthOfASecondAndTheWorkIsNotFinished) {
  work(100);
  EXPECT_EQ(lit_, 100);
  EXPECT_EQ(held_, 240);
  EXPECT_FALSE(station_.finished());
  EXPECT_LT(station_.machine().true_tool_velocity_m_per_s()->norm(), 1e-3) << "of 20 mm/s";
  const auto result = station_.report(folder_, {.rate_hz = 2400.0});
  EXPECT_EQ(result["finished"], false);
  EXPECT_EQ(result["contours_cut"], 1);
  EXPECT_NEAR(result["time_s"].get<double>(), steps_ / 2400.0, 1e-12);
  EXPECT_LT(result["time_s"].get<double>(), result["time_estimate_s"].get<double>());
  EXPECT_EQ(result["closure_gap_um"], 0.0) << "it did not get round";
}

TEST_F(MachiningAtWork, AToolThatRestsElsewhereIsFetchedFirst) {
  const robot::RobotModel model = robot::load_robot("slave-keops");
  for (const double away_m : {90e-6, 110e-6}) {
    *station_.machine().plant() =
        robot::SimulatedRobot(robot::mismatched(model, 0.1, 1001), 1001, model.in_base(Vec3(away_m, 0, 0)));
    station_.begin(*job_);
    // What the sensors do not see is less than the 10 um to either side.
    EXPECT_EQ(station_.time_s() > job_->time_s(), away_m > 100e-6) << away_m;
  }
}

TEST_F(MachiningAtWork, MotorsAtTheirLimitAreCountedAndTheBeamIsOffThen) {
  station_.machine().plant()->set_tool_force({0.0, 0.0, 200.0});
  station_.begin(*job_);
  for (int n = 0; n < 300; ++n) {
    ASSERT_EQ(station_.step(now_ns(), false).laser_w, 0.0);
    station_.machine().plant()->set_tool_force(n < 150 ? Vec3(0.0, 0.0, 200.0) : Vec3(Vec3::Zero()));
  }
  const int violations = station_.report(folder_, {.rate_hz = 2400.0})["limit_violations"];
  EXPECT_GT(violations, 20);
  EXPECT_LT(violations, 300);
}

TEST_F(MachiningAtWork, ReleasedItHasNoCurrentAndTheToolSinks) {
  work();
  station_.release();
  const Vec3 stood_m = *station_.machine().true_tool_m();
  for (int n = 0; n < 50; ++n) station_.machine().plant()->advance(1e-3);
  EXPECT_GT((*station_.machine().true_tool_m() - stood_m).norm(), 100e-6);
}

StationSettings strong() {
  StationSettings settings = quick();
  settings.laser_w = 40.0;
  settings.controller = ControllerKind::kContouring;
  settings.corner = CornerPolicy::kSlow;
  settings.sensor = robot::Sensor::Kind::kEncoder;
  settings.material = &workpiece::kFibreglass;
  return settings;
}

class StrongAtWork : public MachiningAtWork {
 protected:
  StrongAtWork() : MachiningAtWork(strong()) {}
};

TEST_F(StrongAtWork, AStrongerLaserHasMorePulsesOfTheSameEnergy) {
  work();
  const auto result = station_.report(folder_, {.rate_hz = 2400.0});
  EXPECT_EQ(result["controller"], "contouring");
  EXPECT_EQ(result["corner"], "slow");
  EXPECT_EQ(result["sensor"], "encoder");
  EXPECT_EQ(result["burn"]["material"], "fibreglass");
  EXPECT_NEAR(result["burn"]["energy_inside_j"].get<double>(), energy_j_, 0.02);
  EXPECT_GT(energy_j_, 0.9 * 40.0 * 6e-3 / 20e-3);
}

}  // namespace
}  // namespace telekerf::machining
