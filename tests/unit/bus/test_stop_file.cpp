// SPDX-License-Identifier: Apache-2.0
// An emergency stop over a restart: kept whole, and where nobody knows, nothing starts.
#include "common/bus/stop_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/bus/stop_line.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

class StopFileTest : public testing::Test {
 protected:
  StopFileTest() : folder_(fs::path(testing::TempDir()) / ("telekerf-stop-" + std::to_string(::getpid()))) {}
  ~StopFileTest() override { fs::remove_all(folder_); }

  std::string path(const std::string& name = "deep/down.stop") const { return (folder_ / name).string(); }
  void write(const std::string& text) const {
    fs::create_directories(fs::path(path()).parent_path());
    std::ofstream(path()) << text;
  }
  static std::string refusal(const std::string& path) {
    try {
      const StopFile file(path);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(StopFileTest, KeepsAStopAndForgetsIt) {
  const StopFile file(path());
  EXPECT_TRUE(file.found().in_force().empty());
  EXPECT_FALSE(fs::exists(path()));
  EXPECT_EQ(file.keep("7\talice\tsmoke\n9\tbob\t\n"), "");
  const StopFile again(path());
  ASSERT_EQ(again.found().in_force().size(), 2u);
  EXPECT_EQ(again.found().in_force()[0].source, "alice");
  EXPECT_EQ(again.found().order().number, 9u);
  EXPECT_EQ(again.keep(""), "");
  EXPECT_FALSE(fs::exists(path()));
  EXPECT_FALSE(fs::exists(path() + ".new"));
  EXPECT_EQ(again.keep(""), "") << "nothing there is nothing to forget";
  fs::remove_all(folder_);
  EXPECT_EQ(again.keep("7\talice\tsmoke\n"), "") << "somebody had removed the folder";
  EXPECT_EQ(StopFile(path()).found().in_force().size(), 1u);
}

TEST_F(StopFileTest, WhatIsNoStopIsRefused) {
  for (const char* text : {"", "garbage", "7\talice\tsmoke", "7\talice\tsmoke\nrest\n", "\n", "0\ta\tb\n"}) {
    write(text);
    EXPECT_NE(refusal(path()).find("remove the file"), std::string::npos) << text;
  }
  write("7\talice\tsmoke\n");
  EXPECT_EQ(refusal(path()), "");
}

TEST_F(StopFileTest, WhereItCannotBeWrittenNothingStarts) {
  EXPECT_NE(refusal("/proc/nosuch/stop").find("--stop-file off"), std::string::npos);
  fs::create_directories(folder_);
  EXPECT_NE(refusal(folder_.string()).find("it is no file"), std::string::npos);
  EXPECT_EQ(refusal(""), "");
}

TEST_F(StopFileTest, WithoutAHomeNobodyKnowsWhere) {
  const auto kept = [](const char* name) {
    const char* const value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
  };
  const std::string home = kept("HOME"), state = kept("XDG_STATE_HOME");
  ::unsetenv("HOME");
  ::unsetenv("XDG_STATE_HOME");
  BusSettings bus;
  bus.cell = "a/b";
  bus.role = "slave";
  EXPECT_THROW((void)StopFlags{}.path(bus), StartupError);
  EXPECT_EQ(StopFlags{.stop_file = "off"}.path(bus), "");
  EXPECT_EQ(StopFlags{.stop_file = "/x/y"}.path(bus), "/x/y");
  ::setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(StopFlags{}.path(bus), "/home/somebody/.local/state/telekerf/0-a_b-slave.stop");
  home.empty() ? ::unsetenv("HOME") : ::setenv("HOME", home.c_str(), 1);
  if (!state.empty()) ::setenv("XDG_STATE_HOME", state.c_str(), 1);
}

}  // namespace
}  // namespace telekerf
