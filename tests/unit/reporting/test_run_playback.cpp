// SPDX-License-Identifier: Apache-2.0
// What a page plays of a run, byte by byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/reporting/run_playback.h"
#include "tests/unit/reporting/circle_run.h"

namespace telekerf::reporting {
namespace {

struct Played {
  nlohmann::json head;
  std::vector<float> numbers;
  std::size_t rows() const { return numbers.size() / kPlaybackFields.size(); }
  double at(std::size_t row, std::string_view field) const {
    const auto found = std::find(kPlaybackFields.begin(), kPlaybackFields.end(), field);
    return numbers.at(row * kPlaybackFields.size() + static_cast<std::size_t>(found - kPlaybackFields.begin()));
  }
};

Played played(const RunRecord& record) {
  const std::string bytes = playback_of(record, {.name = "n\xff", .created = "2026", .state = "closed"});
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), 4);
  EXPECT_EQ(length % 4, 0u) << "the rows must be aligned";
  Played result;
  result.head = nlohmann::json::parse(bytes.substr(4, length));
  result.numbers.resize((bytes.size() - 4 - length) / 4);
  std::memcpy(result.numbers.data(), bytes.data() + 4 + length, 4 * result.numbers.size());
  EXPECT_EQ(result.rows(), result.head["rows"].get<std::size_t>());
  return result;
}

TEST(RunPlayback, ShowsBothRobotsOfOneMomentAndTheirErrors) {
  RunRecord record = circle_run(40e-6, 3e-6);
  record.master[200].button = true;
  const Played run = played(record);
  ASSERT_EQ(run.rows(), 1000u);
  EXPECT_EQ(run.head["every"], 1);
  EXPECT_NEAR(run.head["step_s"].get<double>(), 1e-3, 1e-12);
  EXPECT_EQ(run.head["name"], "n\uFFFD");
  for (const std::size_t row : {100u, 200u, 900u}) {
    const double angle = static_cast<double>(row) * 2 * M_PI / 1000, lag = 30 * 2 * M_PI / 1000;
    EXPECT_NEAR(run.at(row, "t_s"), 1e-3 * static_cast<double>(row), 1e-6);
    EXPECT_NEAR(run.at(row, "tool_x_m"), 10.02e-3 * std::cos(angle), 1e-8) << "scaled";
    EXPECT_NEAR(run.at(row, "slave_y_m"), 10.023e-3 * std::sin(angle - lag), 1e-8) << "of the same moment";
    EXPECT_NEAR(run.at(row, "speed_m_per_s"), 10.02e-3 * 2 * M_PI, 1e-4);
    EXPECT_NEAR(run.at(row, "slave_speed_m_per_s"), 10.023e-3 * 2 * M_PI, 1e-4);
    EXPECT_NEAR(run.at(row, "off_line_m"), -20e-6, 1e-7) << "outside lies to the right";
    EXPECT_NEAR(run.at(row, "tracking_m"), 3e-6, 1e-9);
    EXPECT_NEAR(run.at(row, "prediction_m"), 7e-6, 1e-9);
    EXPECT_NEAR(run.at(row, "behind_s"), 0.030, 1e-7);
    EXPECT_EQ(run.at(row, "applied_tick"), 470.0 + static_cast<double>(row));
    EXPECT_EQ(run.at(row, "laser_w"), row - 30 < 500 ? 4.0 : 0.0);
    EXPECT_EQ(run.at(row, "button"), row == 200 ? 1.0 : 0.0);
    EXPECT_EQ(run.at(row, "engaged"), 1.0);
  }
  EXPECT_TRUE(std::isnan(run.at(29, "slave_x_m"))) << "the slave was not there yet";
  EXPECT_FALSE(std::isnan(run.at(30, "slave_x_m")));
}

TEST(RunPlayback, AnotherClockIsComparedAndWhatIsNotAppliedHasNoError) {
  RunRecord record = circle_run(0.0, 3e-6);
  for (SlaveRow& row : record.slave) row.t_s += 500.0;
  record.master_figures["clock_offset_us"] = 500e6;
  record.slave[100].applied = -1.0;
  const Played run = played(record);
  EXPECT_NEAR(run.at(500, "tracking_m"), 3e-6, 1e-9);
  EXPECT_TRUE(std::isnan(run.at(130, "tracking_m")));
  EXPECT_TRUE(std::isnan(run.at(130, "behind_s")));
  EXPECT_FALSE(std::isnan(run.at(130, "slave_x_m")));
}

TEST(RunPlayback, SaysWhichContourWasInForceFromWhichRowOn) {
  RunRecord record = circle_run(0.0, 0.0);
  record.earlier.push_back({.until_tick = 700, .closed = false, .points_m = {{0, 0}, {0, 1e-3}}});
  const Played run = played(record);
  ASSERT_EQ(run.head["contours"].size(), 2u);
  EXPECT_EQ(run.head["contours"][0]["from_row"], 0);
  EXPECT_EQ(run.head["contours"][0]["closed"], false);
  EXPECT_EQ(run.head["contours"][0]["points"], nlohmann::json({0.0, 0.0, 0.0, 1e-3}));
  EXPECT_EQ(run.head["contours"][1]["from_row"], 200);
  EXPECT_EQ(run.head["contours"][1]["points"].size(), 7200u);
  EXPECT_NEAR(std::abs(run.at(100, "off_line_m")), std::hypot(10e-3 * std::cos(0.2 * M_PI), 10e-3 * std::sin(0.2 * M_PI) - 1e-3), 1e-7);
  EXPECT_NEAR(run.at(300, "off_line_m"), 0.0, 1e-7);
}

TEST(RunPlayback, OfALongRunEveryFewTicksAndOfNoneNothing) {
  RunRecord record = circle_run(0.0, 0.0);
  const MasterRow last = record.master.back();
  while (record.master.size() < kMostPlaybackRows + 3) {
    record.master.push_back(last);
    record.master.back().tick = record.master.front().tick + record.master.size() - 1;
    record.master.back().t_s = 1e-3 * static_cast<double>(record.master.size() - 1);
  }
  const Played run = played(record);
  EXPECT_EQ(run.head["every"], 2);
  EXPECT_EQ(run.rows(), kMostPlaybackRows / 2 + 2);
  EXPECT_NEAR(run.head["step_s"].get<double>(), 2e-3, 1e-9);
  EXPECT_NEAR(run.at(400, "t_s"), 0.8, 1e-6);
  EXPECT_EQ(played(RunRecord{}).rows(), 0u);
}

}  // namespace
}  // namespace telekerf::reporting
