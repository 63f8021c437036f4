// SPDX-License-Identifier: Apache-2.0
// `cmake --install` into a prefix: programs that find their data there, and what belongs to them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;

class Installed : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string log = (Program::scratch() / "install.txt").string();
    const std::string command =
        "cmake --install '" TELEKERF_BUILD_DIR "' --prefix '" + prefix().string() + "' >'" + log + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << log;
  }
  static fs::path prefix() { return Program::scratch() / "prefix"; }

  /// The exit code of an installed program, started far from the source.
  static int run(const std::string& words) {
    const std::string command = "cd '" + Program::scratch().string() + "' && unset TELEKERF_DATA && '" +
                                prefix().string() + "/bin/'" + words + " >said.txt 2>&1";
    const int status = std::system(command.c_str());
    return WEXITSTATUS(status);
  }

  static std::string said() {
    std::ifstream in(Program::scratch() / "said.txt");
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(Installed, HasAllProgramsAndNothingElseToRun) {
  std::istringstream names(TELEKERF_PROGRAMS);
  std::set<std::string> programs;
  for (std::string name; std::getline(names, name, ',');) programs.insert(name);
  programs.insert("telekerf-tell");  // the old name of telekerf-ctl, which says the new one
  EXPECT_GT(programs.size(), 6u);
  std::set<std::string> installed;
  for (const auto& entry : fs::directory_iterator(prefix() / "bin"))
    installed.insert(entry.path().filename().string());
  EXPECT_EQ(installed, programs);
}

TEST_F(Installed, HasTheSameDataAsTheBuild) {
  for (const std::string kind : {"robots", "profiles", "pictures"}) {
    int files = 0;
    for (const auto& entry : fs::directory_iterator(TELEKERF_BUILD_DIR "/share/telekerf/" + kind)) {
      EXPECT_TRUE(fs::exists(prefix() / "share/telekerf" / kind / entry.path().filename())) << entry.path();
      ++files;
    }
    EXPECT_GT(files, 2) << kind;
  }
  for (const std::string file : {"README.md", "LICENSE", "docs"})
    EXPECT_TRUE(fs::exists(prefix() / "share/doc/telekerf" / file)) << file;
}

TEST_F(Installed, ProgramsFindWhatTheyNeed) {
  EXPECT_EQ(run("telekerf-inspect robot slave-keops --fk 0.02 0.02 0.02"), 0) << said();
  EXPECT_EQ(run("telekerf-experiment lap --image circle --netem lan --duration-s 2 --out lap"), 0) << said();
  EXPECT_TRUE(fs::exists(Program::scratch() / "lap/report.json"));
  // Not the build's: without its own it has none.
  fs::rename(prefix() / "share/telekerf/robots", prefix() / "share/telekerf/elsewhere");
  EXPECT_EQ(run("telekerf-inspect robot slave-keops --fk 0.02 0.02 0.02"), 2) << said();
  fs::rename(prefix() / "share/telekerf/elsewhere", prefix() / "share/telekerf/robots");
}

TEST(Programs, AreConfiguredWithoutThePackagesOfTheTests) {
  const std::string folder = (Program::scratch() / "programs only").string();
  std::string command = "cmake -S '" TELEKERF_SOURCE_DIR "' -B '" + folder + "' -G Ninja";
  for (const std::string part : {"TESTS", "BENCHMARKS", "EXPERIMENTS", "EXAMPLES"})
    command += " -DTELEKERF_BUILD_" + part + "=OFF";
  for (const std::string package : {"GTest", "CycloneDDS"})
    command += " -DCMAKE_DISABLE_FIND_PACKAGE_" + package + "=ON";
  ASSERT_EQ(std::system((command + " >/dev/null").c_str()), 0);
  const std::string targets =
      "ninja -C '" + folder + "' -t query telekerf-master telekerf-slave telekerf-vision telekerf-inspect";
  EXPECT_EQ(std::system((targets + " >/dev/null").c_str()), 0);
  EXPECT_NE(std::system(("ninja -C '" + folder + "' -t query telekerf-experiment >/dev/null 2>&1").c_str()),
            0);
}

}  // namespace
}  // namespace telekerf::integration
