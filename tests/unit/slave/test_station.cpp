// SPDX-License-Identifier: Apache-2.0
// The slave's settings with their bounds, contours that it refuses, and the figures of its report.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "common/runtime/startup_error.h"
#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

template <class Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(SlaveStation, AContourMayReachTheWorkspacesEdgeAndNoFurther) {
  const Station station{StationSettings{}};
  const double edge_m = robot::load_robot("slave-keops").workspace.radius_m;
  const auto reaching = [](double x_m, double y_m) {
    ContourMessage contour;
    contour.id = 3;
    contour.closed = false;
    contour.points_m = {{0.0, 0.0}, {x_m, y_m}, {1e-3, 0.0}};
    return contour;
  };
  for (const Vec2& towards : {Vec2(1, 0), Vec2(0, -1)}) {
    const auto corridor = station.prepare(reaching(edge_m * towards.x(), edge_m * towards.y()));
    EXPECT_EQ(corridor->contour_id, 3u);
    EXPECT_FALSE(corridor->contour.line().closed);
    const double too_far_m = edge_m + 1e-6;
    EXPECT_NE(refusal_of([&] {
                (void)station.prepare(reaching(too_far_m * towards.x(), too_far_m * towards.y()));
              }).find("use a smaller --width-mm"),
              std::string::npos);
  }
  EXPECT_EQ(refusal_of([&] { (void)station.prepare(reaching(0.06, 0.08)); }),
            fmt::format("the contour reaches 100.0 mm from the workspace's centre, but slave-keops reaches "
                        "{:.1f} mm; use a smaller --width-mm",
                        1e3 * edge_m));
}

TEST(SlaveStation, TheControlRateIsAWholeMultipleOfTheStreams) {
  const auto refusal = [](double control_hz, double stream_hz) {
    StationSettings settings;
    settings.node.control_hz = control_hz;
    settings.node.stream_hz = stream_hz;
    return refusal_of([&] { (void)settings.validated(); });
  };
  EXPECT_EQ(refusal(2400, 1200), "accepted");
  EXPECT_EQ(refusal(1000, 1000), "accepted");
  ASSERT_LT(2102.1 / 700.7, 3.0) << "but for its rounding";
  EXPECT_EQ(refusal(2102.1, 700.7), "accepted");
  for (const auto& [control_hz, stream_hz] :
       {std::pair{500.0, 1000.0}, {1500.0, 1000.0}, {1000.0001, 1000.0}, {1000.000005, 1000.0}}) {
    EXPECT_NE(refusal(control_hz, stream_hz).find("must be a whole multiple of stream_hz"), std::string::npos)
        << control_hz;
  }
}

TEST(SlaveStation, ARatioIsWholeAlsoWhereItIsRoundedDown) {
  StationSettings settings;
  settings.node.control_hz = 2102.1;
  settings.node.stream_hz = 700.7;
  Station station(settings);
  int blocks = 0;
  for (int n = 0; n < 200; ++n) {
    const SlaveOutputs out = station.step(n * kMs / 2, nullptr, {}, {});
    if (!out.state) continue;
    EXPECT_EQ(out.state->ticks_per_sample, 3);
    ++blocks;
  }
  EXPECT_EQ(blocks, 200 / (3 * 16));
}

TEST(SlaveStation, MoreThanItsLaserMayGiveIsRefusedWithTheSettings) {
  StationSettings settings;
  settings.beam.laser_max_w = 5.0;
  EXPECT_EQ(
      refusal_of([&] { (void)settings.validated(); }).find("laser_w = 10 must be at most laser_max_w = 5"),
      0u);
  settings.node.laser_w = 5.0;
  EXPECT_EQ(refusal_of([&] { (void)settings.validated(); }), "accepted");
}

TEST(SlaveStation, BothPartsOfTheStateStreamAreCutAndCodedAlike) {
  StationSettings settings;
  settings.node.stream_hz = 500.0;
  settings.node.feedback.block = 32;
  settings.node.feedback.redundancy = 3;
  settings.codec = codec::kCodecs.find("dpcm").value();
  const SlaveSettings node = settings.validated().node;
  EXPECT_EQ(node.feedback.sample_period_ns, 2'000'000u);
  EXPECT_EQ(node.force.sample_period_ns, 2'000'000u);
  EXPECT_EQ(node.force.block, 32);
  EXPECT_EQ(node.force.redundancy, 3);
  EXPECT_EQ(node.force.kind, node.feedback.kind);
  EXPECT_NE(node.force.kind, codec::StreamSettings{}.kind);
  settings.codec = codec::kDefaultCodec;
  settings.node.force.keep = 32;
  EXPECT_EQ(settings.validated().node.force.keep, 32);
  settings.node.force.keep = 33;
  EXPECT_NE(refusal_of([&] { (void)settings.validated(); }).find("keep = 33: a block of 32 samples"),
            std::string::npos);
}

/// Tells where it stands as often as the test says, and remembers the currents.
class ToldRobot : public robot::Robot {
 public:
  robot::JointReading read() noexcept override {
    robot::JointReading reading;
    reading.joints_m = joints_m;
    reading.valid = readings > 0;
    reading.tick = ++tick_;
    readings -= readings > 0 ? 1 : 0;
    return reading;
  }
  void write(const Vec3& currents_a) noexcept override {
    ++writes;
    currents_a_ = currents_a;
  }
  robot::Capabilities capabilities() const override { return {.name = "told", .max_rate_hz = 1e4}; }

  Vec3 joints_m = Vec3::Zero();
  int readings = 1;
  int writes = 0;
  Vec3 currents_a_ = Vec3::Zero();

 private:
  std::uint64_t tick_ = 0;
};

class ToldLaser : public laser::Laser {
 public:
  explicit ToldLaser(std::vector<double>& told_w) : told_w_(told_w) {}
  bool emit(const laser::Emission& emission) noexcept override {
    EXPECT_FALSE(emission.pilot) << "nobody has asked for it";
    told_w_.push_back(emission.power_w);
    return true;
  }

 private:
  std::vector<double>& told_w_;
};

class StationOfADrive : public testing::Test {
 protected:
  StationOfADrive() {
    const robot::RobotModel model = robot::load_robot("slave-keops");
    auto robot = std::make_unique<ToldRobot>();
    robot_ = robot.get();
    robot_->joints_m = *robot::DeltaKinematics(model.geometry).inverse(model.in_base(Vec3(0, 0, 1e-3)));
    station_.emplace(StationSettings{}, robot::Drive{std::move(robot), nullptr},
                     std::make_unique<ToldLaser>(told_w_));
  }
  SlaveOutputs step(const StopOrder& stop = {}) { return station_->step(now_ns_ += kMs, nullptr, {}, stop); }

  std::vector<double> told_w_;
  ToldRobot* robot_ = nullptr;
  std::optional<Station> station_;
  std::int64_t now_ns_ = 0;
};

TEST_F(StationOfADrive, BeforeTheLoopsFirstReadingBeamAndCurrentsAreOffAndAStopIsHeard) {
  robot_->writes = 0;
  told_w_.clear();
  StopOrder stop;
  for (int n = 1; n <= 3; ++n) {
    if (n == 2) stop.number = 5;
    const SlaveOutputs out = step(stop);
    EXPECT_EQ(out.stop, stop.number);
    EXPECT_EQ(out.laser_w, 0.0);
    EXPECT_EQ(out.currents_a, Vec3(Vec3::Zero()));
    EXPECT_FALSE(out.settled || out.state);
    EXPECT_LT(out.applied_tick, 0.0);
    EXPECT_EQ(out.mode, SlaveMode::kWaiting) << "nobody asked it";
    EXPECT_EQ(robot_->writes, n) << "each step, so that a drive's watchdog is content";
    EXPECT_EQ(told_w_, std::vector<double>(static_cast<std::size_t>(n), 0.0));
  }
  robot_->readings = 1;
  EXPECT_EQ(step(stop).mode, SlaveMode::kStopped);
}

TEST_F(StationOfADrive, ReleasedItHasNeitherBeamNorCurrent) {
  robot_->readings = 100;
  for (int n = 0; n < 10; ++n) (void)step();
  for (int n = 0; n < 10; ++n) {
    robot_->joints_m.x() += 1e-6;  // pushed, no slip of its sensor
    (void)step();
  }
  ASSERT_GT(robot_->currents_a_.norm(), 1e-3) << "back to where it was";
  const std::size_t told = told_w_.size();
  EXPECT_EQ(told, 1u + 20u) << "at its beginning and each step";
  RunRecord record;
  station_->report(record);
  EXPECT_FALSE(record.slave_drive.true_tool) << "nobody knows it";
  station_->release();
  EXPECT_EQ(robot_->currents_a_, Vec3(Vec3::Zero()));
  ASSERT_EQ(told_w_.size(), told + 1);
  EXPECT_EQ(told_w_.back(), 0.0);
}

TEST(SlaveStation, ItsSettingsHaveTheseDefaultsAndBounds) {
  StationSettings station;
  Settings settings;
  station.add_parameters(settings);
  struct Row {
    const char* name;
    double min;
    double max;
  };
  constexpr Row kRows[] = {{"laser_max_w", 0, 1000},
                           {"mismatch", 0, 0.5},
                           {"control_hz", 200, 20000},
                           {"stream_hz", 100, 10000},
                           {"block", 4, 64},
                           {"keep", 1, 64},
                           {"max_rms", 0, 1},
                           {"force_keep", 1, 64},
                           {"force_max_rms", 0, 1000},
                           {"redundancy", 0, 7},
                           {"bandwidth_rad_s", 0, 5000},
                           {"observer_rad_s", 0, 15000},
                           {"stale_s", 0.02, 10},
                           {"laser_w", 0, 1000},
                           {"laser_speed_mm_s", 0.5, 200},
                           {"dose_max_j", 0.01, 1000},
                           {"dose_max_j_per_mm2", 0.1, 1000}};
  for (const Row& row : kRows) {
    bool found = false;
    for (const Setting& setting : settings.declared()) {
      if (setting.name != row.name) continue;
      found = true;
      EXPECT_EQ(setting.bounds.min, row.min) << row.name;
      EXPECT_EQ(setting.bounds.max, row.max) << row.name;
    }
    EXPECT_TRUE(found) << row.name;
  }
  const auto declared = settings.declared();
  for (const char* name : {"robot", "drive", "laser", "seed", "codec"}) {
    EXPECT_EQ(std::count_if(declared.begin(), declared.end(),
                            [&](const Setting& setting) { return setting.name == name; }),
              1)
        << name;
  }
  EXPECT_EQ(station.node.control_hz, 1000.0);
  EXPECT_EQ(station.node.stream_hz, 1000.0);
  EXPECT_EQ(station.node.bandwidth_rad_s, 0.0);
  EXPECT_EQ(station.node.observer_rad_s, 0.0);
  EXPECT_EQ(station.node.transfer.rate_rad_per_s, 200.0);
  EXPECT_EQ(station.node.transfer.max_acceleration_m_per_s2, 5.0);
  EXPECT_EQ(station.node.interlock.max_tracking_error_m, 50e-6);
  EXPECT_EQ(station.node.interlock.max_offset_m, 2e-6);
  EXPECT_EQ(station.node.command_timeout_s, 0.15);
  EXPECT_EQ(station.node.laser_w, 10.0);
  EXPECT_EQ(station.laser_speed_mm_s, 10.0);
  EXPECT_EQ(station.node.interlock.max_dose_j, 2.0);
  EXPECT_EQ(station.node.interlock.max_area_dose_j_per_mm2, 20.0);
  EXPECT_EQ(station.node.force.max_rms, 0.025);
  EXPECT_EQ(station.node.force.quantum, 0.01);
  EXPECT_FALSE(station.node.force.anchored);
  EXPECT_EQ(station.mismatch, 0.1);
  EXPECT_EQ(station.epoch, 1u);
  EXPECT_EQ(station.seed, 1u);
  EXPECT_EQ(station.record_s, 120.0);
}

TEST_F(SlaveNodeTest, ItsFiguresAreThoseOfTheRun) {
  std::uint64_t bytes = 0;
  each_tick_ = [&] {
    if (out_.state) bytes += out_.state->payload.size + out_.state->force.size;
  };
  follow(1.0);
  RunRecord record;
  station_.report(record);
  Metrics& f = record.slave_figures;
  EXPECT_EQ(f["rate_hz"], 1000.0);
  EXPECT_EQ(f["control_period_s"], 1e-3);
  EXPECT_EQ(f["blocks"], 62.0);
  EXPECT_EQ(f["lost"] + f["stale"] + f["refused"] + f["missed_ticks"] + f["dropped_rows"], 0.0);
  EXPECT_EQ(f["block"], 16.0);
  const double run_s = 62 * 0.016;
  EXPECT_NEAR(f["payload_bytes_per_s"], static_cast<double>(bytes) / run_s, 1e-6);
  EXPECT_NEAR(f["position_bits_per_sample"] + f["force_bits_per_sample"],
              8.0 * static_cast<double>(bytes) / (62 * 3 * 16), 1e-9);
  EXPECT_GT(f["position_bits_per_sample"], 0.0);
  EXPECT_NEAR(f["playout_ms"], 6.0, 1e-9) << "4 samples of look-ahead and 2 ms";
  EXPECT_EQ(f["playout_corrections"], 0.0);
  EXPECT_EQ(record.slave_drive.name, "simulated");
  EXPECT_TRUE(record.slave_drive.true_tool);
  ASSERT_EQ(record.slave.size(), 62u * 16u);
  EXPECT_EQ(record.slave.back().laser_w, out_.laser_w);
  EXPECT_EQ(record.slave.back().applied, out_.applied_tick);
  EXPECT_NEAR(record.slave.back().t_s, run_s - 1e-3, 1e-12);
}

TEST_F(SlaveNodeTest, OneBlocksFiguresAreItsOwn) {
  std::size_t bytes = 0;
  each_tick_ = [&] {
    if (out_.state) bytes += out_.state->payload.size;
  };
  run(next_block());
  RunRecord record;
  station_.report(record);
  EXPECT_EQ(record.slave_figures["blocks"], 1.0);
  EXPECT_NEAR(record.slave_figures["position_bits_per_sample"], 8.0 * static_cast<double>(bytes) / 48.0,
              1e-12);
}

TEST_F(SlaveNodeTest, ItsStateStreamIsCountedInItsOwnStepsAndMayChangeItsBlocks) {
  std::vector<StateBlock> blocks;
  each_tick_ = [&] {
    if (out_.state) blocks.push_back(*out_.state);
  };
  follow(0.1);
  ASSERT_EQ(blocks.size(), 6u);
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    EXPECT_EQ(blocks[n].first_tick, 16 * n);
    EXPECT_EQ(blocks[n].contour_id, 1u);
  }
  blocks.clear();
  SlaveSettings node = StationSettings{}.validated().node;
  node.feedback.block = node.force.block = 8;
  station_.change(node.feedback, node.force);
  follow(0.1);
  ASSERT_EQ(blocks.size(), 12u) << "twice as many, of half the length";
  for (std::size_t n = 0; n < blocks.size(); ++n) EXPECT_EQ(blocks[n].first_tick, 6 * 16 + 8 * n);
}

TEST(SlaveStation, WhatNobodyHasSetAsksForNothing) {
  EXPECT_EQ(SlaveCounters{}.missed_ticks, 0u);
  EXPECT_EQ(SlaveCounters{}.states, 0u);
  EXPECT_EQ(StateReportSettings{}.ticks_per_sample, 1);
  EXPECT_EQ(ReportSample{}.contour_id, 0u);
  EXPECT_FALSE(ReportSample{}.laser_on);
  const Selected nothing;
  EXPECT_FALSE(nothing.following || nothing.bare || nothing.button);
  EXPECT_LT(nothing.applied_tick, 0.0);
  const SlaveOutputs out;
  EXPECT_EQ(out.laser_w, 0.0);
  EXPECT_EQ(out.applied_tick, -1.0);
  EXPECT_FALSE(out.settled);
  EXPECT_EQ(SlaveInputs{}.corridor, nullptr);
}

}  // namespace
}  // namespace telekerf::slave
