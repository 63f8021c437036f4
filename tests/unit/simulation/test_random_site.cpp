// SPDX-License-Identifier: Apache-2.0
// Robots, hands and networks drawn at random: the same again for the same seed, and nothing burnt outside.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "common/reporting/run_report.h"
#include "common/robot/robot_model.h"
#include "common/runtime/startup_error.h"
#include "experiments/robots/random_site.h"

namespace telekerf::experiments {
namespace {

class RandomSites : public testing::Test {
 protected:
  RandomSites() { std::filesystem::create_directories(folder_); }
  ~RandomSites() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("sites-" + std::to_string(::getpid()));
};

TEST_F(RandomSites, AreTheSameForTheSameSeedAndOthersForAnother) {
  std::set<std::string> drawn;
  std::set<double> masses;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomSite site = random_site(seed, 12.0, folder_);
    EXPECT_EQ(site.drawn, random_site(seed, 12.0, folder_).drawn);
    drawn.insert(site.drawn.dump());
    const auto robot = robot::load_robot(site.settings.slave.robot);
    masses.insert(robot.motor.mass_kg);
    EXPECT_GT(robot.workspace.radius_m, 5e-3);
    EXPECT_LE(robot.drive_delay_s, 1.5e-3);
    EXPECT_LE(site.settings.slave.mismatch, 0.3);
    EXPECT_LE(site.settings.master.hand.disturbances.size(), 3u);
  }
  EXPECT_EQ(drawn.size(), 20u);
  EXPECT_EQ(masses.size(), 20u);
}

TEST_F(RandomSites, NoneBurnsOutsideItsCorridorOrFarFromTheMasterAndNearlyAllCut) {
  int cut = 0;
  int thrown = 0;
  double farthest_um = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const RandomSite site = random_site(seed, 6.0, folder_);
    nlohmann::ordered_json report;
    try {
      report = reporting::make_report(simulation::simulate(site.settings));
    } catch (const StartupError& failure) {
      EXPECT_EQ(failure.kind(), ErrorKind::kHardware) << failure.what();
      ++thrown;
      continue;
    }
    EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0) << site.drawn.dump();
    if (report["cut"]["energy_inside_j"].get<double>() == 0.0) continue;
    ++cut;
    farthest_um = std::max(farthest_um, report["tracking"]["laser_on"]["max_um"].get<double>());
  }
  EXPECT_EQ(thrown, 2) << "centimetres off the contour by hands stronger than their motors";
  EXPECT_EQ(cut, 10);
  EXPECT_LE(farthest_um, 95.0) << "50 um of the master's guard, and what it predicted wrongly";
}

}  // namespace
}  // namespace telekerf::experiments
