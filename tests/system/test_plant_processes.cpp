// SPDX-License-Identifier: Apache-2.0
// A slave that is killed or hangs while it cuts, as the plant outside sees it: dark by itself, and never lit
// again without a new engagement. What counts is the plant's book.
#include <gtest/gtest.h>

#include <utility>

#include "tests/system/plant_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kSilence_s = 0.003;  ///< docs/how-to/add-a-laser.md
/// What may go by between a look at the clock and the fault: signals take their time on a busy machine.
constexpr double kMargin_s = 0.1;
constexpr double kNever_s = 1e9;

/// Nothing fell beside the contour, and every light that nobody ended was over within the silence.
void expect_no_harm(const nlohmann::json& book) {
  ASSERT_TRUE(book.is_object()) << "the plant has left no book";
  EXPECT_EQ(book["energy_outside_corridor_j"].get<double>(), 0.0) << book;
  EXPECT_GT(book["energy_inside_j"].get<double>(), 1.0) << "it had been cutting";
  EXPECT_LE(book["dark_after_s_max"].get<double>(), kSilence_s) << book;
  EXPECT_LE(book["dose_j_max"].get<double>(), 2.0) << book;
}

TEST(PlantProcesses, ASlaveThatIsKilledLeavesTheDarkAndItsSuccessorWaitsForTheOperator) {
  PlantCell cell("killed", {});
  ASSERT_TRUE(cell.lit()) << cell.said();
  std::this_thread::sleep_for(milliseconds(500));
  cell.slave->kill();
  const double killed_s = clock_s();
  std::this_thread::sleep_for(milliseconds(600));
  cell.start_slave();
  ASSERT_TRUE(cell.slave->says("ready", seconds(20))) << cell.said();
  std::this_thread::sleep_for(seconds(3));
  const double engaged_s = clock_s();
  const int before = cell.lights_said();
  EXPECT_EQ(cell.tell({"engage"}), 0);
  EXPECT_TRUE(cell.lit(before)) << cell.said();
  std::this_thread::sleep_for(milliseconds(500));
  const auto book = cell.book();
  expect_no_harm(book);
  EXPECT_EQ(energy_j(book, killed_s + kMargin_s, engaged_s), 0.0) << book;
  EXPECT_GT(energy_j(book, engaged_s, kNever_s), 0.0) << "one engagement is enough";
}

TEST(PlantProcesses, ASlaveThatHangsIsDarkMeanwhileAndAfterMoreThanTheGateWaitsForTheOperator) {
  PlantCell cell("hung", {});
  ASSERT_TRUE(cell.lit()) << cell.said();
  std::this_thread::sleep_for(milliseconds(500));
  std::vector<std::pair<double, double>> dark;  // from, to
  for (const int hung_ms : {50, 200, 600, 2000}) {
    cell.slave->interrupt(SIGSTOP);
    const double from_s = clock_s() + kMargin_s;
    std::this_thread::sleep_for(milliseconds(hung_ms));
    double to_s = clock_s();
    cell.slave->interrupt(SIGCONT);
    if (hung_ms > 350) {  // the gate: --beam-age-s
      std::this_thread::sleep_for(milliseconds(1500));
      const int before = cell.lights_said();
      to_s = clock_s();
      EXPECT_EQ(cell.tell({"engage"}), 0);
      EXPECT_TRUE(cell.lit(before)) << hung_ms << " ms: one engagement is enough\n" << cell.said();
    }
    dark.emplace_back(from_s, to_s);
    std::this_thread::sleep_for(milliseconds(700));
  }
  const auto book = cell.book();
  expect_no_harm(book);
  for (const auto& [from_s, to_s] : dark)
    EXPECT_EQ(energy_j(book, from_s, to_s), 0.0) << to_s - from_s << book;
  EXPECT_GT(energy_j(book, dark.back().second, kNever_s), 0.0);
}

TEST(PlantProcesses, ALaserThatIsStuckIsCutOffAndEndsTheSlave) {
  PlantCell cell("stuck", {.plant = {"--stuck-after-j", "3"}, .master = {"--engage"}});
  EXPECT_EQ(cell.slave->wait(seconds(60)), 2) << cell.said();
  const double ended_s = clock_s();
  EXPECT_TRUE(cell.slave->says("gives light though it was told to be off", seconds(1))) << cell.said();
  std::this_thread::sleep_for(milliseconds(300));
  const auto book = cell.book();
  expect_no_harm(book);
  EXPECT_TRUE(book["laser_stuck"].get<bool>());
  EXPECT_EQ(energy_j(book, ended_s, kNever_s), 0.0) << book;
}

}  // namespace
}  // namespace telekerf::integration
