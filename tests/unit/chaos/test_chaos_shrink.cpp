// SPDX-License-Identifier: Apache-2.0
// A failing run becomes as short and as simple as it may be, and the command line says it.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/runtime/startup_error.h"
#include "experiments/chaos/shrink.h"

namespace telekerf::experiments {
namespace {

ChaosSettings failing() {
  ChaosSettings settings;
  settings.seed = 42;
  settings.duration_s = 20.0;
  settings.kinds = {FaultKind::kLoss, FaultKind::kStop, FaultKind::kForger, FaultKind::kBeta};
  return settings;
}

bool has(const ChaosSettings& settings, FaultKind kind) {
  return std::find(settings.kinds.begin(), settings.kinds.end(), kind) != settings.kinds.end();
}

TEST(Shrink, KeepsTheFaultsAndTheTimeThatAreNeededAndNoOthers) {
  int tried = 0;
  const auto fails = [&](const ChaosSettings& settings) {
    ++tried;
    return settings.duration_s >= 3.7 && has(settings, FaultKind::kStop) && has(settings, FaultKind::kForger);
  };
  const ChaosSettings smallest = shrink(failing(), fails);
  EXPECT_TRUE(fails(smallest));
  EXPECT_EQ(smallest.kinds, (std::vector{FaultKind::kStop, FaultKind::kForger}));
  EXPECT_LT(smallest.duration_s, 3.7 / 0.9 + 0.1);
  EXPECT_EQ(smallest.mode, ChaosMode::kSafety) << "healing is not the matter";
  EXPECT_LT(tried, 30);
  EXPECT_NE(command_line(smallest).find("chaos --runs 1 --seed 42 --duration-s "), std::string::npos);
  EXPECT_NE(command_line(smallest).find("--mode safety --faults stop,forger"), std::string::npos);
}

TEST(Shrink, KeepsTheHealingWhereItIsTheMatter) {
  const auto fails = [](const ChaosSettings& settings) { return settings.mode == ChaosMode::kLiveness; };
  const ChaosSettings smallest = shrink(failing(), fails);
  EXPECT_EQ(smallest.mode, ChaosMode::kLiveness);
  EXPECT_TRUE(smallest.kinds.empty());
  EXPECT_EQ(shortest_s(ChaosMode::kLiveness), 8.0);
  EXPECT_GE(smallest.duration_s, 8.0) << "a shorter run is refused: it could not recover, faults or none";
  EXPECT_LT(smallest.duration_s, 9.0);
  EXPECT_NE(command_line(smallest).find("--mode liveness --faults none"), std::string::npos);
}

TEST(Shrink, TheCommandLineNamesAGateThatIsNotTheUsualOne) {
  ChaosSettings settings = failing();
  EXPECT_EQ(command_line(settings).find("--beam-age-s"), std::string::npos);
  settings.set_gate(0.1);
  EXPECT_TRUE(command_line(settings).ends_with(" --beam-age-s 0.1"));
}

TEST(Shrink, LeavesWhatCannotBeSmaller) {
  const ChaosSettings whole = failing();
  const ChaosSettings same = shrink(whole, [](const ChaosSettings&) { return false; });
  EXPECT_EQ(same.kinds, whole.kinds);
  EXPECT_EQ(same.duration_s, whole.duration_s);
}

TEST(Faults, AreReadAsTheyAreWritten) {
  EXPECT_TRUE(parse_faults("none").empty());
  EXPECT_EQ(parse_faults("loss"), std::vector{FaultKind::kLoss});
  EXPECT_EQ(parse_faults("stop,forger"), (std::vector{FaultKind::kStop, FaultKind::kForger}));
  EXPECT_THROW((void)parse_faults("loss,"), StartupError);
  EXPECT_THROW((void)parse_faults("gremlin"), StartupError);
}

}  // namespace
}  // namespace telekerf::experiments
