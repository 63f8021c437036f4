// SPDX-License-Identifier: Apache-2.0
// ./telekerf from a folder that is not its own: what the user names is looked for where the user stands, and
// a refusal leaves nothing behind.
#include <gtest/gtest.h>

#include "tests/system/robot_process.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;

struct Ended {
  int code;
  std::string out, err;
};

class Script : public testing::Test {
 protected:
  Script() {
    fs::remove_all(here_);
    fs::create_directories(here_ / "no-build");
    // The programs are built; a ninja that does nothing keeps the build out of the tests.
    std::ofstream(here_ / "no-build" / "ninja") << "#!/bin/sh\necho 'ninja: no work to do.'\n";
    fs::permissions(here_ / "no-build" / "ninja", fs::perms::owner_all);
  }

  Ended run(const std::string& words) const {
    const std::string quoted = "'" + here_.string() + "'";
    const std::string command = "cd " + quoted + " && PATH=" + quoted +
                                "/no-build:\"$PATH\" CI= TELEKERF_BUILD='" TELEKERF_BUILD_DIR
                                "' '" TELEKERF_SCRIPT "' " +
                                words + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), text_of("out.txt"), text_of("err.txt")};
  }

  std::string text_of(const fs::path& file) const {
    std::ifstream in(here_ / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const fs::path here_ = Program::scratch() / "where the user stands";
};

TEST_F(Script, CutsAPictureThatLiesWhereTheUserStands) {
  fs::copy_file(TELEKERF_BIN_DIR "/../share/telekerf/pictures/circle.png", here_ / "ein Bild.png");
  fs::copy_file(TELEKERF_BIN_DIR "/../share/telekerf/profiles/lan.toml", here_ / "mein netz.toml");
  const Ended demo =
      run("demo --image 'ein Bild.png' --out 'aus gabe/1' --duration-s=3 --netem './mein netz.toml' "
          "--domain " +
          own_domain());
  EXPECT_EQ(demo.code, 0) << demo.out << demo.err;
  EXPECT_EQ(demo.err, "");
  for (const std::string file : {"report.json", "cut.png", "trace.csv", "master.csv", "slave.csv"})
    EXPECT_TRUE(fs::exists(here_ / "aus gabe/1" / file)) << file;
  EXPECT_NE(text_of("aus gabe/1/report.json").find("\"netem\": \"mein netz\""), std::string::npos);
  for (const auto& entry : fs::directory_iterator(here_ / "aus gabe/1"))
    EXPECT_FALSE(entry.is_directory()) << entry.path();
}

TEST_F(Script, ARefusedDemoLeavesNothing) {
  const Ended demo = run("demo --image nowhere.png --out new/run --domain " + own_domain());
  EXPECT_EQ(demo.code, 2);
  EXPECT_EQ(std::count(demo.err.begin(), demo.err.end(), '\n'), 1) << demo.err;
  EXPECT_FALSE(fs::exists(here_ / "new"));
}

TEST_F(Script, ARefusedDemoLeavesAnEarlierRunAlone) {
  fs::create_directories(here_ / "run");
  std::ofstream(here_ / "run" / "slave.csv") << "earlier";
  EXPECT_EQ(run("demo --image nowhere.png --out run --domain " + own_domain()).code, 2);
  EXPECT_EQ(text_of("run/slave.csv"), "earlier");
  EXPECT_EQ(std::distance(fs::directory_iterator(here_ / "run"), fs::directory_iterator()), 1);
}

TEST_F(Script, WhatWasCutBeforeTheDriveDiedIsKept) {
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  std::jthread end_of_it([&] {
    // What the slave says comes with the end of the script; its record is in a draft until then.
    const auto cutting = [&] { return text_of("out.txt").find("cutting") != std::string::npos; };
    for (int n = 0; n < 600 && !cutting(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::this_thread::sleep_for(std::chrono::seconds(1));
    robot.kill();
  });
  const Ended machine =
      run("machine circle --width-mm 12 --out cut --drive " + robot.drive() + " --domain " + own_domain());
  EXPECT_EQ(machine.code, 2) << machine.out << machine.err;
  EXPECT_NE(machine.err.find("no reading for"), std::string::npos) << machine.err;
  EXPECT_NE(text_of("cut/result.json").find("\"finished\": false"), std::string::npos);
  EXPECT_TRUE(fs::exists(here_ / "cut/trace.csv"));
}

TEST_F(Script, MachinesWithARobotOfTheUsersOwn) {
  fs::copy_file(TELEKERF_BIN_DIR "/../share/telekerf/robots/slave-keops.toml", here_ / "my robot.toml");
  const Ended bright =
      run("machine circle --width-mm 5 --speed-mm-s 50 --robot 'my robot.toml' --laser-w 30 --laser-max-w 20 "
          "--out cut --domain " +
          own_domain());
  EXPECT_EQ(bright.code, 2) << bright.out;
  EXPECT_NE(bright.err.find("laser_max_w = 20"), std::string::npos) << bright.err;
  std::ofstream(here_ / "no robot.toml") << "[geometry]\nbase_radius_m = -1\n";
  const Ended none = run("machine circle --robot 'no robot.toml' --out cut --domain " + own_domain());
  EXPECT_EQ(none.code, 2) << none.out;
  EXPECT_NE(none.err.find("no robot.toml: geometry.base_radius_m"), std::string::npos) << none.err;
  const Ended cut =
      run("machine circle --width-mm 5 --speed-mm-s 50 --robot 'my robot.toml' --machining-hz 2000 "
          "--out cut --domain " +
          own_domain());
  EXPECT_EQ(cut.code, 0) << cut.out << cut.err;
  EXPECT_TRUE(fs::exists(here_ / "cut/mark.png"));
}

TEST_F(Script, AskedForHelpItBuildsNothingAndInstallsNothing) {
  for (const std::string command : {"setup", "build", "demo", "machine"}) {
    const Ended help = run(command + " --help");
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_NE(help.out.find("./telekerf setup "), std::string::npos) << command << help.out;
  }
  EXPECT_EQ(run("build everything").code, 2);
  const Ended version = run("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out, TELEKERF_VERSION "\n");
}

}  // namespace
}  // namespace telekerf::integration
