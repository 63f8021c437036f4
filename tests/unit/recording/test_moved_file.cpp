// SPDX-License-Identifier: Apache-2.0
// A file that somebody moves or removes while a process records into it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "common/recording/process_recording.h"
#include "common/recording/rows.h"
#include "common/recording/run_reader.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class MovedFile : public testing::Test {
 protected:
  MovedFile() : folder_(fs::temp_directory_path() / ("telekerf-moved-" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "run");
  }
  ~MovedFile() override { fs::remove_all(folder_); }

  static RunIdentity identity() { return {.role = "master", .program = "test", .cell = "cell-1", .epoch = 7}; }
  static std::vector<Recording::Part> parts() { return {{schema_of("master", master_columns(), true), 1000.0}}; }
  std::string said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  Recording::Say say() {
    return [this](const std::string& sentence) {
      const std::lock_guard lock(mutex_);
      said_ += sentence + "\n";
    };
  }
  bool hears(const std::string& words) {
    for (int n = 0; n < 500; ++n) {
      if (said().find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }

  fs::path folder_;
  std::mutex mutex_;
  std::string said_;
};

TEST_F(MovedFile, OneWhoseFolderIsRenamedGoesOnThere) {
  Recording recording(folder_ / "run" / "master.h5", identity(), parts(), say());
  recording.ring(0).push(master_columns(), {.tick = 0, .t_s = 0.0});
  fs::rename(folder_ / "run", folder_ / "kept");
  EXPECT_TRUE(hears("has been moved: it goes on as " + (folder_ / "kept" / "master.h5").string())) << said();
  recording.ring(0).push(master_columns(), {.tick = 1, .t_s = 1e-3});
  ASSERT_TRUE(recording.close({})) << said();
  EXPECT_EQ(RunReader(folder_ / "kept" / "master.h5").data("master")->rows(), 2U);
  EXPECT_EQ(said().find("removed"), std::string::npos) << said();
}

TEST_F(MovedFile, OneThatIsMovedAtTheLastMomentIsFinishedWhereItIs) {
  Recording recording(folder_ / "run" / "master.h5", identity(), parts(), say());
  recording.ring(0).push(master_columns(), {.tick = 0, .t_s = 0.0});
  while (recording.acknowledged() < 1) std::this_thread::sleep_for(milliseconds(1));
  fs::rename(folder_ / "run" / "master.h5", folder_ / "other.h5");
  ASSERT_TRUE(recording.close({})) << said();
  EXPECT_EQ(RunReader(folder_ / "other.h5").state(), RunState::kClosed);
  EXPECT_FALSE(fs::exists(folder_ / "run" / "master.h5"));
}

TEST_F(MovedFile, OneThatIsRemovedIsMissedAtOnce) {
  Recording recording(folder_ / "run" / "master.h5", identity(), parts(), say());
  std::this_thread::sleep_for(milliseconds(100));
  fs::remove(folder_ / "run" / "master.h5");
  EXPECT_TRUE(hears("has been removed")) << said();
  EXPECT_FALSE(recording.close({}));
}

TEST_F(MovedFile, ARunThatShallBeRecordedDoesNotEndWellWithoutItsRecord) {
  for (const bool named : {true, false}) {
    fs::create_directories(folder_ / "run");
    fs::current_path(folder_);
    StatusReporter status("test");
    ProcessRecording recording({.record = named ? (folder_ / "run").string() : ""}, identity(), parts(), status);
    EXPECT_NO_THROW(recording.refuse_unfinished()) << "it has not ended yet";
    fs::remove(recording.file());
    EXPECT_FALSE(recording.close({}));
    if (named) {
      EXPECT_THROW(recording.refuse_unfinished(), StartupError);
    } else {
      EXPECT_NO_THROW(recording.refuse_unfinished()) << "nobody has asked for it";
    }
  }
  fs::current_path("/");
}

}  // namespace
}  // namespace telekerf
