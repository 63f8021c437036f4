// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/recording/run_folder.h"
#include "common/recording/run_record.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

TEST(RunRecord, AFolderThatHoldsAnotherRunOfTheSiteIsRefused) {
  const fs::path folder = fs::path(testing::TempDir()) / ("record-" + std::to_string(getpid()));
  EXPECT_NO_THROW(refuse_record_folder("--record", folder, "master")) << "it is not there yet";
  EXPECT_FALSE(fs::exists(folder)) << "nothing is made";
  RunRecord record;
  record.master.push_back({.tick = 3});
  write_contour(folder, record);
  write_master(folder, record);
  EXPECT_NO_THROW(refuse_record_folder("--record", folder, "slave")) << "both sites may share it";
  try {
    refuse_record_folder("--record", folder, "master");
    ADD_FAILURE();
  } catch (const StartupError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kEnvironment);
    EXPECT_EQ(error.what(), "--record " + folder.string() +
                                ": holds the record of another run (master.json); name another folder");
  }
  fs::remove_all(folder);
}

TEST(RunRecord, ContoursThatWereInForceBeforeAreKept) {
  const fs::path folder = fs::temp_directory_path() / ("telekerf-contours-" + std::to_string(::getpid()));
  RunRecord record;
  record.contour_m = {{0.0, 0.0}, {0.01, 0.0}};
  record.earlier = {{70, false, {{0.001, 0.002}, {0.003, 0.004}, {0.005, 0.006}}}, {90, true, {{1.0, 2.0}}}};
  write_contour(folder, record);
  write_master(folder, record);
  write_slave(folder, record);
  const RunRecord back = read_run(folder);
  ASSERT_EQ(back.earlier.size(), 2u);
  EXPECT_EQ(back.earlier[0].until_tick, 70u);
  EXPECT_FALSE(back.earlier[0].closed);
  EXPECT_EQ(back.earlier[0].points_m, record.earlier[0].points_m);
  EXPECT_TRUE(back.earlier[1].closed);
  EXPECT_EQ(back.contour_m, record.contour_m);
  fs::remove_all(folder);
}

TEST(RunRecord, AFolderThatAddsNothingToTheFirstIsRefused) {
  const fs::path place = fs::temp_directory_path() / ("telekerf-idle-" + std::to_string(::getpid()));
  RunRecord record;
  record.master.push_back({.tick = 3});
  write_master(place / "both", record);
  write_slave(place / "both", record);
  write_slave(place / "slave", record);
  fs::create_directories(place / "nothing");
  const auto refusal = [&](const std::vector<fs::path>& folders) -> std::string {
    try {
      refuse_idle_folders(folders);
      return "";
    } catch (const StartupError& error) {
      return error.what();
    }
  };
  EXPECT_NE(refusal({place / "both", place / "slave"}).find("has the recordings of slave already"), std::string::npos);
  EXPECT_NE(refusal({place / "slave", place / "nothing"}).find("holds no recording of a run"), std::string::npos);
  EXPECT_EQ(refusal({place / "slave", place / "both"}), "") << "it adds the master";
  EXPECT_EQ(refusal({place / "nothing"}), "") << "that is said elsewhere";
  fs::remove_all(place);
}

TEST(RunRecord, ARecorderCountsWhatItHasNoRoomFor) {
  Recorder<SlaveRow> recorder(2);
  for (std::uint64_t tick = 0; tick < 5; ++tick) recorder.push({.tick = tick});
  ASSERT_EQ(recorder.rows().size(), 2U);
  EXPECT_EQ(recorder.rows().back().tick, 1U);
  EXPECT_EQ(recorder.dropped(), 3U);
}

}  // namespace
}  // namespace telekerf
