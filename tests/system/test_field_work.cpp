// SPDX-License-Identifier: Apache-2.0
// What goes wrong in the field while the beam is on, on real processes: what is said then, and what goes on.
#include "tests/system/field_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

TEST_F(Field, WhoIsStoppedIsNotScaledEngagedOrTiredOfWaitingAndASwitchThatNobodyMakesIsNoSuccess) {
  const auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage", "--duration-s", "60", "--wait-s", "8"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  const auto [switched, switch_said] = say({"switch", "geo"}, "telekerf-netem");
  EXPECT_EQ(switched, 2);
  for (const char* role : {"master: ", "slave: ", "vision: "})
    EXPECT_NE(switch_said.find(std::string(role) + "the network stays as it is"), std::string::npos)
        << switch_said;
  EXPECT_EQ(say({"stop"}).first, 0);
  for (const std::vector<std::string>& what : {std::vector<std::string>{"engage"}, {"beta", "0.4"}}) {
    const auto [code, said] = say(what);
    EXPECT_EQ(code, 2) << said;
    EXPECT_NE(said.find("refused while stopped"), std::string::npos) << said;
  }
  std::this_thread::sleep_for(seconds(5));  // with what has passed: longer than it would wait
  EXPECT_TRUE(master->running()) << master->output();
}

TEST_F(Field, TheSamePictureAgainChangesNothingAndAnotherOneWaitsForTheOperator) {
  auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  for (const auto* const side : {slave.get(), master.get()}) {
    EXPECT_NE(side->output().find(": works on contour "), std::string::npos) << side->output();
    EXPECT_NE(side->output().find("(circle.png, "), std::string::npos) << side->output();
  }
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
  EXPECT_EQ(said.find("moving to the contour", before.size()), std::string::npos)
      << "the old one stays: " << said;
  const std::string id =
      said.substr(said.find("take-contour ") + 13,
                  said.find('\n', said.find("take-contour ")) - said.find("take-contour ") - 13);
  EXPECT_EQ(say({"take-contour", "1"}).first, 2) << "nobody has seen that one";
  const auto [code, taken] = say({"take-contour", id});
  EXPECT_EQ(code, 0) << taken;
  EXPECT_TRUE(slave->says("is in force now", seconds(5))) << slave->output();
  EXPECT_EQ(master->output().find("engaged", master->output().find("is in force now")), std::string::npos)
      << "not engaged by itself";
}

TEST_F(Field, AContourThatOneSideCannotTakeIsTakenByNeitherAndTheOneBeforeGoesOn) {
  auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  vision->kill();
  // Within the slave's reach, and at the master's scale beyond the master's.
  vision = start("telekerf-vision", {"--image", "circle", "--width-mm", "80"});
  ASSERT_TRUE(master->says("take-contour", seconds(20))) << master->output();
  ASSERT_TRUE(slave->says("take-contour", seconds(20))) << slave->output();
  const std::string waits = slave->output();
  const std::size_t at = waits.find("take-contour ") + 13;
  const auto [code, said] = say({"take-contour", waits.substr(at, waits.find('\n', at) - at)});
  EXPECT_EQ(code, 2) << said;
  EXPECT_NE(said.find("master: contour "), std::string::npos) << said;
  EXPECT_NE(said.find("; slave, which had taken it, goes back to the one before"), std::string::npos) << said;
  ASSERT_TRUE(slave->says("is not taken by both sides (master: contour ", seconds(5))) << slave->output();
  ASSERT_TRUE(slave->says("is in force again", seconds(5))) << slave->output();
  const std::size_t before = slave->output().size();
  std::this_thread::sleep_for(seconds(2));
  EXPECT_EQ(slave->output().find("slave: following", before), std::string::npos)
      << "not by itself: " << slave->output();
  EXPECT_EQ(say({"engage"}).first, 0);
  const auto follows = [&] { return slave->output().find("slave: following", before) != std::string::npos; };
  for (int n = 0; n < 300 && !follows(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(follows()) << slave->output() << master->output();
}

TEST_F(Field, AFirstContourThatDoesNotFitEndsNobodyAndTheNextOneIsCut) {
  // Sized for a robot that reaches farther than the slave.
  auto vision =
      start("telekerf-vision", {"--image", "circle", "--robot", "master-horizontal", "--width-mm", "106"});
  const auto slave = start("telekerf-slave");
  const auto master = start("telekerf-master", {"--engage"});
  ASSERT_TRUE(slave->says("refused: the contour reaches 30.1 mm", seconds(30))) << slave->output();
  ASSERT_TRUE(master->says("refused: ", seconds(30))) << master->output();
  std::this_thread::sleep_for(seconds(1));
  ASSERT_TRUE(slave->running() && master->running()) << slave->output() << master->output();
  vision->kill();
  vision = start("telekerf-vision", {"--image", "circle"});
  EXPECT_TRUE(slave->says("beam on", seconds(30))) << slave->output() << master->output();
}

TEST_F(Field, AStopWaitsForASlaveThatHangsAndForTheMasterThatComesNext) {
  const auto vision = start("telekerf-vision", {"--image", "circle"});
  const auto slave = start("telekerf-slave");
  auto master = start("telekerf-master", {"--engage", "--stop-file", "off"});
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  slave->interrupt(SIGSTOP);
  const auto [code, said] = say({"stop"});
  EXPECT_EQ(code, 2) << said;
  EXPECT_NE(said.find("master has confirmed it, but no slave is seen in cell 'field'"), std::string::npos)
      << said;
  const std::size_t before = slave->output().size();
  slave->interrupt(SIGCONT);
  EXPECT_TRUE(slave->says("stopped: laser off until clear-stop", seconds(5))) << slave->output();
  master->kill();
  master = start("telekerf-master", {"--engage", "--stop-file", "off"});
  EXPECT_TRUE(master->says("stopped", seconds(20))) << master->output();
  EXPECT_EQ(slave->output().find("beam on", before), std::string::npos) << slave->output();
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
  EXPECT_EQ(first->wait(seconds(40)), 2) << first->output();
  EXPECT_TRUE(first->says("this one gives way", seconds(1))) << first->output();
  EXPECT_TRUE(std::filesystem::exists(out + "/master.json")) << "with its record";
  EXPECT_TRUE(rival->says("this one stays", seconds(10))) << rival->output();
}

}  // namespace
}  // namespace telekerf::integration
