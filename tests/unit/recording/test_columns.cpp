// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "common/recording/rows.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

fs::path file_of(const std::string& text) {
  fs::path file = fs::path(testing::TempDir()) / "columns.csv";
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::string refusal_of(const std::string& text) {
  const fs::path file = file_of(text);
  try {
    (void)read_csv(file, slave_columns());
  } catch (const StartupError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    return std::string(error.what()).substr(file.string().size());
  }
  return "none";
}

TEST(Columns, HeadersAreWhatOthersRead) {
  EXPECT_EQ(
      header_of(master_columns()),
      "tick,t_s,tool_x_m,tool_y_m,tool_z_m,hand_x_n,hand_y_n,hand_z_n,constraint_n,guided,engaged,button,"
      "predicted_x_m,predicted_y_m,predicted_z_m,joined,force_tick,slave_force_x_n,slave_force_y_n,"
      "slave_force_z_n,beta");
  EXPECT_EQ(
      header_of(slave_columns()),
      "tick,t_s,applied_tick,ref_x_m,ref_y_m,ref_z_m,tool_x_m,tool_y_m,tool_z_m,laser_w,interlock,settled,"
      "force_x_n,force_y_n,force_z_n");
  EXPECT_EQ(header_of(contour_columns()), "x_m,y_m");
}

TEST(Columns, LinesHoldTheShortestNumbersThatReadBack) {
  SlaveRow row;
  row.tick = 7;
  row.t_s = 0.1;
  row.applied = -1;
  row.ref_m = {1e-7, -0.25, 3};
  row.laser_w = 10;
  row.interlock = 4;
  row.settled = true;
  const std::string text = csv_of<SlaveRow>(slave_columns(), std::vector{row});
  EXPECT_EQ(text.substr(text.find('\n') + 1), "7,0.1,-1,1e-07,-0.25,3,0,0,0,10,4,1,0,0,0\n");
}

/// Every column goes to its own place and comes back from there, bit for bit.
TEST(Columns, WhatIsWrittenReadsBack) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<MasterRow> rows(50);
  for (MasterRow& row : rows) {
    row.tick = random() >> 20;
    for (double* number : {&row.t_s, &row.constraint_n, &row.beta, &row.force_tick})
      *number = std::ldexp(any(random), static_cast<int>(random() % 60) - 30);
    for (Vec3* vector : {&row.tool_m, &row.hand_n, &row.predicted_m, &row.slave_force_n})
      *vector = Vec3(any(random), any(random), any(random));
    for (bool* flag : {&row.guided, &row.engaged, &row.button, &row.joined}) *flag = random() % 2 == 0;
  }
  rows[3].tool_m.x() = -0.0;
  rows[4].tool_m.y() = std::numeric_limits<double>::denorm_min();
  const auto back = read_csv(file_of(csv_of<MasterRow>(master_columns(), rows)), master_columns());
  ASSERT_EQ(back.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& column : master_columns())
      EXPECT_EQ(column.read(back[i]), column.read(rows[i])) << column.name << " of row " << i;
    EXPECT_EQ(back[i].tool_m, rows[i].tool_m);
    EXPECT_EQ(back[i].engaged, rows[i].engaged);
    EXPECT_EQ(back[i].slave_force_n, rows[i].slave_force_n);
    EXPECT_EQ(back[i].beta, rows[i].beta);
  }
  EXPECT_TRUE(std::signbit(back[3].tool_m.x()));
}

TEST(Columns, WhatIsNoRecordIsRefusedByLine) {
  const std::string header = header_of(slave_columns()) + "\n";
  EXPECT_EQ(refusal_of("x,y\n"), ": line 1 must be '" + header_of(slave_columns()) + "'");
  EXPECT_EQ(refusal_of(""), ": line 1 must be '" + header_of(slave_columns()) + "'");
  const std::string good = "1,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
  EXPECT_EQ(refusal_of(header + good + "1,2,3\n"), ": line 3 must hold 15 numbers");
  EXPECT_EQ(refusal_of(header + "1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,9\n"), ": line 2 must hold 15 numbers");
  EXPECT_EQ(refusal_of(header + "1,0,0,0,0,0,0,x,0,0,0,0,0,0,0\n"), ": line 2 must hold 15 numbers");
  EXPECT_EQ(refusal_of(header + good), "none");
}

TEST(Columns, EveryOneHasAUnitOrIsACountAndPositionsHaveFrames) {
  const auto look = [](const auto& columns) {
    for (const auto& column : columns) {
      const bool metres_or_newtons = column.name.ends_with("_m") || column.name.ends_with("_n");
      EXPECT_EQ(column.unit, column.name.ends_with("_m")   ? "m"
                             : column.name.ends_with("_n") ? "N"
                             : column.name.ends_with("_s") ? "s"
                             : column.name.ends_with("_w") ? "W"
                                                           : "")
          << column.name;
      if (metres_or_newtons && column.name != "constraint_n") {
        EXPECT_NE(column.frame, "") << column.name;
      }
    }
  };
  look(master_columns());
  look(slave_columns());
  look(contour_columns());
}

}  // namespace
}  // namespace telekerf
