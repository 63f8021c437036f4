// SPDX-License-Identifier: Apache-2.0
// The master's settings: their bounds, and what follows from them.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "common/runtime/startup_error.h"
#include "master/station_settings.h"

namespace telekerf::master {
namespace {

TEST(MasterSettings, HaveTheseBounds) {
  StationSettings station;
  Settings settings;
  station.add_parameters(settings);
  struct Row {
    const char* name;
    double min;
    double max;
  };
  constexpr Row kRows[] = {{"beta", 0.01, 10},
                           {"mismatch", 0, 0.5},
                           {"control_hz", 200, 20000},
                           {"stream_hz", 100, 10000},
                           {"half_window", 1, 32},
                           {"corridor_mm", 0, 10},
                           {"corridor_stiffness_n_per_m", 0, 20000},
                           {"constraint_rad_s", 0, 5000},
                           {"virtual_mass_kg", 0.1, 20},
                           {"virtual_drag_ns_per_m", 0, 200},
                           {"observer_rad_s", 0, 15000},
                           {"hand_speed_mm_s", 0.1, 200},
                           {"hand_sideways_n", 0, 30},
                           {"tracking_rad_s", 0, 5000},
                           {"block", 4, 64},
                           {"keep", 1, 64},
                           {"max_rms", 0, 1000},
                           {"redundancy", 0, 7},
                           {"max_redundancy", 0, 7}};
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
}

TEST(MasterSettings, TheStreamFollowsFromRatesAndLaw) {
  StationSettings station;
  station.node.control_hz = 2400;
  station.node.stream_hz = 1200;
  station.hand_speed_mm_s = 30;
  station.corridor_mm = 0.4;
  for (const Law law : {Law::kAnchored, Law::kRemoteAcceleration, Law::kLocal}) {
    station.node.command.law = law;
    const StationSettings valid = station.validated();
    const CommandStreamSettings& command = valid.node.command;
    EXPECT_EQ(command.ticks_per_sample, 2);
    EXPECT_EQ(command.codec.sample_period_ns, 833'333u);
    EXPECT_EQ(command.codec.anchored, law == Law::kLocal);
    EXPECT_EQ(command.codec.integrated, law != Law::kLocal);
    EXPECT_EQ(command.codec.quantum, law == Law::kLocal ? codec::StreamSettings{}.quantum : 1e-2);
    EXPECT_EQ(command.approach.max_acceleration_m_per_s2, law == Law::kRemoteAcceleration ? 0.5 : 5.0);
    EXPECT_EQ(command.approach.rate_rad_per_s, law == Law::kRemoteAcceleration ? 20.0 : 40.0);
    EXPECT_EQ(valid.hand.speed_m_per_s, 30e-3);
    EXPECT_EQ(valid.node.constraint.corridor_m, 0.4e-3);
  }
}

TEST(MasterSettings, ASlaveIsLetGoAfterItsGateButNotBeforeHalfASecond) {
  StationSettings settings;
  EXPECT_EQ(settings.validated().node.stale_s, 0.5);
  settings.beam_age_s = 1.7;
  EXPECT_EQ(settings.validated().node.stale_s, 1.7);
}

TEST(MasterSettings, RatesThatCannotWorkAreRefused) {
  StationSettings station;
  const auto refused = [&](double stream_hz, int block, double tracking_rad_s) {
    station.node.control_hz = station.node.stream_hz = stream_hz;
    station.node.command.codec.block = block;
    station.tracking_rad_s = tracking_rad_s;
    try {
      (void)station.validated();
      return std::string();
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(refused(200, 32, 0).find("a slave that hears nothing for 150 ms stops"), std::string::npos);
  EXPECT_NE(refused(200, 32, 0).find("take 160 ms and must take less than 75"), std::string::npos);
  EXPECT_NE(refused(200, 15, 0), "") << "75 ms";
  EXPECT_EQ(refused(200, 14, 0), "");
  EXPECT_NE(refused(500, 16, 401).find("tracking_rad_s = 401 is too fast for stream_hz = 500: at most 400"),
            std::string::npos);
  EXPECT_EQ(refused(500, 16, 400), "");
  station.tracking_rad_s = 0;
  EXPECT_EQ(station.validated().node.command.tracking_rad_s, 200.0) << "0.4 of the stream's rate";
  station.node.control_hz = station.node.stream_hz = 2000;
  EXPECT_EQ(station.validated().node.command.tracking_rad_s, 400.0) << "but no more than this";
}

TEST(MasterSettings, TheControlRateIsAWholeMultipleOfTheStreams) {
  for (const auto& [control_hz, stream_hz] :
       {std::pair{500.0, 1000.0}, {1500.0, 1000.0}, {1000.0001, 1000.0}}) {
    StationSettings station;
    station.node.control_hz = control_hz;
    station.node.stream_hz = stream_hz;
    try {
      (void)station.validated();
      ADD_FAILURE() << control_hz;
    } catch (const StartupError& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("must be a whole multiple of stream_hz = 1000"),
                std::string::npos);
    }
  }
}

}  // namespace
}  // namespace telekerf::master
