// SPDX-License-Identifier: Apache-2.0
// What goes wrong in the field, on real processes: what is said then, and what goes on.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

std::vector<std::string> in_cell(std::vector<std::string> arguments, const std::string& cell = "field") {
  arguments.insert(arguments.end(), {"--domain", own_domain(), "--cell", cell});
  return arguments;
}

class Field : public testing::Test {
 protected:
  /// No stop of an earlier test holds.
  Field() { std::filesystem::remove_all(Program::scratch() / "state"); }
  static std::unique_ptr<Program> start(const std::string& program, const std::vector<std::string>& more = {}) {
    return std::make_unique<Program>(program, in_cell(more));
  }
  /// Exit code of telekerf-ctl, and what it said.
  static std::pair<int, std::string> say(const std::vector<std::string>& what,
                                         const std::string& program = "telekerf-ctl") {
    Program said(program, in_cell(what));
    const int code = said.wait(seconds(20));
    return {code, said.output()};
  }
};

TEST_F(Field, WhoWaitsSaysForWhatWhoIsSeenAndWhatToTry) {
  const Program elsewhere("telekerf-vision", in_cell({"--image", "circle"}, "next-door"));
  const auto slave = start("telekerf-slave");
  EXPECT_TRUE(slave->says("waiting for a contour; seen in cell 'field' of domain " + own_domain() +
                              ": nobody; elsewhere: vision in cell 'next-door'; give both the same --cell",
                          seconds(15)))
      << slave->output();
}

TEST_F(Field, WhoIsStoppedIsNotScaledEngagedOrTiredOfWaitingAndASwitchThatNobodyMakesIsNoSuccess) {
  const auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage", "--duration-s", "60", "--wait-s", "2"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  const auto [switched, switch_said] = say({"switch", "geo"}, "telekerf-netem");
  EXPECT_EQ(switched, 2);
  for (const char* role : {"master: ", "slave: ", "vision: "})
    EXPECT_NE(switch_said.find(std::string(role) + "the network stays as it is"), std::string::npos) << switch_said;
  EXPECT_EQ(say({"stop"}).first, 0);
  for (const std::vector<std::string>& what : {std::vector<std::string>{"engage"}, {"beta", "0.4"}}) {
    const auto [code, said] = say(what);
    EXPECT_EQ(code, 2) << said;
    EXPECT_NE(said.find("refused while stopped"), std::string::npos) << said;
  }
  std::this_thread::sleep_for(seconds(2));
  EXPECT_TRUE(master->running()) << master->output();
}

TEST_F(Field, AStopThatNoSlaveConfirmsIsNoSuccess) {
  const auto master = start("telekerf-master");
  ASSERT_TRUE(master->says("ready", seconds(20))) << master->output();
  const auto [code, said] = say({"stop"});
  EXPECT_EQ(code, 2) << said;
  EXPECT_NE(said.find("master has confirmed it, but no slave is seen"), std::string::npos) << said;
}

TEST_F(Field, TheSamePictureAgainChangesNothingAndAnotherOneWaitsForTheOperator) {
  auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  const std::string before = master->output();
  vision->kill();
  vision = start("telekerf-vision", {"--image", "circle"});
  ASSERT_TRUE(vision->says("circle.png", seconds(20)));
  std::this_thread::sleep_for(seconds(1));
  EXPECT_EQ(master->output(), before) << "not even a word";
  vision->kill();
  vision = start("telekerf-vision", {"--image", "gear"});
  ASSERT_TRUE(master->says("take-contour", seconds(20))) << master->output();
  ASSERT_TRUE(slave->says("take-contour", seconds(20))) << slave->output();
  const std::string said = master->output();
  EXPECT_NE(said.find("(gear.png, "), std::string::npos) << said;
  EXPECT_NE(said.find("(circle.png, "), std::string::npos) << said;
  EXPECT_EQ(said.find("moving to the contour", before.size()), std::string::npos) << "the old one stays: " << said;
  const std::string id = said.substr(said.find("take-contour ") + 13, said.find('\n', said.find("take-contour ")) -
                                                                          said.find("take-contour ") - 13);
  EXPECT_EQ(say({"take-contour", "1"}).first, 2) << "nobody has seen that one";
  const auto [code, taken] = say({"take-contour", id});
  EXPECT_EQ(code, 0) << taken;
  EXPECT_TRUE(slave->says("is in force now", seconds(5))) << slave->output();
  EXPECT_EQ(master->output().find("engaged", master->output().find("is in force now")), std::string::npos)
      << "not engaged by itself";
}

/// Output into a pipe that nobody reads.
TEST_F(Field, AReaderOfTheOutputThatGoesEndsNothing) {
  const std::string out = (Program::scratch() / "piped").string();
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[0]);
    ::close(ends[1]);
    const std::string program = std::string(TELEKERF_BIN_DIR) + "/telekerf-slave";
    ::execl(program.c_str(), program.c_str(), "--record", out.c_str(), "--domain", own_domain().c_str(), "--cell",
            "piped", nullptr);
    ::_exit(127);
  }
  ::close(ends[1]);
  char first = 0;
  EXPECT_EQ(::read(ends[0], &first, 1), 1);
  ::close(ends[0]);
  std::this_thread::sleep_for(seconds(4));  // it says that it waits
  EXPECT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "it runs on";
  ::kill(child, SIGINT);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(std::filesystem::exists(out + "/slave.json"));
}

TEST_F(Field, OfTwoMastersThatCouldNotSeeEachOtherOneGivesWay) {
  const auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const std::string out = (Program::scratch() / "first").string();
  const auto first = start("telekerf-master", {"--engage", "--record", out});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  first->interrupt(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(6500));  // longer than it is believed to be there
  const auto rival = start("telekerf-master", {"--engage"});
  EXPECT_TRUE(rival->says("engaged: the slave follows", seconds(20))) << rival->output();
  first->interrupt(SIGCONT);
  EXPECT_EQ(first->wait(seconds(20)), 2) << first->output();
  EXPECT_TRUE(first->says("this one gives way", seconds(1))) << first->output();
  EXPECT_TRUE(std::filesystem::exists(out + "/master.json")) << "with its record";
  EXPECT_TRUE(rival->says("this one stays", seconds(10))) << rival->output();
}

TEST_F(Field, TheLinkIsTriedBeforeTheWorkInWordsAndNumbers) {
  const auto slave = start("telekerf-slave", {"--link-test", "--link-test-s", "2", "--json", "--peer", "127.0.0.1"});
  const auto master = start("telekerf-master", {"--link-test", "--link-test-s", "2"});
  const int code = master->wait(seconds(30));
  EXPECT_TRUE(code == 0 || code == 1) << master->output();
  EXPECT_TRUE(master->says("loss, operator to slave, 10 times block rate", seconds(1))) << master->output();
  EXPECT_TRUE(master->says("the link is ", seconds(1))) << master->output();
  EXPECT_GE(slave->wait(seconds(30)), 0);
  const std::string said = slave->output();
  const auto json = nlohmann::json::parse(said.substr(said.find('{')), nullptr, false);
  ASSERT_TRUE(json.is_object()) << said;
  EXPECT_GT(json["forward"]["ten_times.packets"].get<double>(), 200.0);
  EXPECT_GT(json["backward"]["block_rate.packets"].get<double>(), 30.0);
  EXPECT_GT(json["rtt_p50_ms"].get<double>(), 0.0);
}

TEST_F(Field, ALinkThatIsTooSlowForTheGateIsToldBeforeTheWorkAndNamesTheOption) {
  const std::vector<std::string> slow{"--netem", "geo"};
  const auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave", slow);
  const auto master = start("telekerf-master", slow);
  EXPECT_TRUE(master->says("the link is too slow for the laser", seconds(30))) << master->output();
  EXPECT_TRUE(master->says("--beam-age-s", seconds(1)));
  EXPECT_EQ(master->output().find("engaged"), std::string::npos) << "before anybody engages";
}

}  // namespace
}  // namespace telekerf::integration
