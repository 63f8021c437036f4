// SPDX-License-Identifier: Apache-2.0
// What goes wrong in the field, on real processes: what is said then, and what goes on.
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/system/field_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

TEST_F(Field, WhoWaitsSaysForWhatWhoIsSeenAndWhatToTry) {
  const Program elsewhere("telekerf-vision", in_cell({"--image", "circle"}, "next-door"));
  const auto slave = start("telekerf-slave");
  EXPECT_TRUE(slave->says("waiting for a contour; seen in cell 'field' of domain " + own_domain() +
                              ": nobody; elsewhere: vision in cell 'next-door'; give both the same --cell",
                          seconds(15)))
      << slave->output();
}

TEST_F(Field, AStopThatNoSlaveConfirmsIsNoSuccess) {
  const auto master = start("telekerf-master");
  ASSERT_TRUE(master->says("ready", seconds(20))) << master->output();
  const auto [code, said] = say({"stop"});
  EXPECT_EQ(code, 2) << said;
  EXPECT_NE(said.find("master has confirmed it, but no slave is seen"), std::string::npos) << said;
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
    ::execl(program.c_str(), program.c_str(), "--record", out.c_str(), "--domain", own_domain().c_str(),
            "--cell", "piped", nullptr);
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

TEST_F(Field, AMasterThatGivesUpKeepsItsRecord) {
  const std::filesystem::path out = Program::scratch() / "alone";
  const auto master =
      start("telekerf-master", {"--engage", "--duration-s", "1", "--wait-s", "1", "--record", out.string()});
  EXPECT_EQ(master->wait(seconds(20)), 2) << master->output();
  EXPECT_GT(std::filesystem::file_size(out / "master.h5"), 0u);
}

TEST_F(Field, TheLinkIsTriedBeforeTheWorkInWordsAndNumbers) {
  const auto slave =
      start("telekerf-slave", {"--link-test", "--link-test-s", "2", "--json", "--peer", "127.0.0.1"});
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
