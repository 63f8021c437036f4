// SPDX-License-Identifier: Apache-2.0
// A slave that hangs or is killed while it cuts, and a laser that sticks, as the plant outside sees them. The
// other faults of real processes take longer: chaos_processes.cpp.
#include <gtest/gtest.h>

#include "tests/system/plant_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

class PlantProcesses : public CellAtWork {};

TEST_F(PlantProcesses, ASlaveThatHangsOrIsKilledIsDarkAtOnceAndItsLightWaitsForTheOperator) {
  begin();
  hang(*cell->slave, 200);
  hang(*cell->slave, 600);
  cell->slave->kill();
  const double killed_s = clock_s() + kMargin_s;
  sleep_ms(600);  // the devices let go of it
  cell->start_slave();
  ASSERT_TRUE(cell->slave->says("ready", seconds(20))) << cell->said();
  dark_until_engaged(killed_s);
}

TEST_F(PlantProcesses, ALaserThatIsStuckIsCutOffAndEndsTheSlave) {
  begin({.plant = {"--stuck-after-j", "3"}, .master = {"--engage"}});
  EXPECT_EQ(cell->slave->wait(seconds(60)), 2) << cell->said();
  dark.emplace_back(clock_s(), kNever_s);
  EXPECT_TRUE(cell->slave->says("gives light that it was not told to give", seconds(1))) << cell->said();
  judge = [](const nlohmann::json& book) { EXPECT_TRUE(book["laser_stuck"].get<bool>()) << book; };
}

}  // namespace
}  // namespace telekerf::integration
