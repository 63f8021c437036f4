// SPDX-License-Identifier: Apache-2.0
// Faults of real processes, one after another, while a cell cuts: ./telekerf check processes. The judge is
// the book of the plant, which is none of them.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include "common/bus/endpoints.h"
#include "experiments/chaos/attackers.h"
#include "tests/system/plant_cell.h"

namespace telekerf::integration {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class ProcessChaos : public CellAtWork {
 protected:
  /// Settings of somebody else in the cell.
  BusSettings stranger() const {
    BusSettings settings;
    settings.domain = std::stoi(own_domain());
    settings.cell = cell_name();
    settings.role = "stranger";
    settings.epoch = 7;
    return settings;
  }
  /// Light now, by nobody's doing.
  void still_lit() {
    const double from_s = clock_s();
    sleep_ms(1000);
    judge = [from_s, before = judge](const nlohmann::json& book) {
      before(book);
      EXPECT_GT(energy_j(book, from_s, from_s + 1.0), 0.0) << book;
    };
  }
};

TEST_F(ProcessChaos, AHungSlave) {
  begin();
  for (const int ms : {50, 100, 200, 500, 2000}) hang(*cell->slave, ms);
}

TEST_F(ProcessChaos, AHungMaster) {
  begin();
  // The play-out has some milliseconds left; then silence is noticed after 0.15 s at the latest.
  for (const int ms : {50, 200, 2000}) {
    cell->master->interrupt(SIGSTOP);
    const double from_s = clock_s() + 0.3;
    sleep_ms(ms);
    cell->master->interrupt(SIGCONT);
    if (ms > kGate_ms) {
      dark_until_engaged(from_s);
    } else {
      sleep_ms(400);
    }
  }
}

TEST_F(ProcessChaos, AKilledSlave) {
  begin();
  for (int n = 0; n < 2; ++n) {
    cell->slave->kill();
    const double killed_s = clock_s() + kMargin_s;
    sleep_ms(600);
    cell->start_slave();
    ASSERT_TRUE(cell->slave->says("ready", seconds(20))) << cell->said();
    dark_until_engaged(killed_s);
  }
}

TEST_F(ProcessChaos, AKilledMaster) {
  begin();
  cell->master->kill();
  const double killed_s = clock_s() + 0.3;
  cell->flags.master = {"--button", "pressed"};
  sleep_ms(1500);  // its place in the cell is free again
  cell->start_master();
  ASSERT_TRUE(cell->master->says("guiding the hand", seconds(30))) << cell->said();
  dark_until_engaged(killed_s);
}

TEST_F(ProcessChaos, AKilledVision) {
  begin();
  cell->vision->kill();
  still_lit();
}

TEST_F(ProcessChaos, AHungPlant) {
  begin();
  for (const int ms : {20, 50, 200}) hang(*cell->plant, ms);
  cell->plant->interrupt(SIGSTOP);
  EXPECT_EQ(cell->slave->wait(seconds(20)), 2) << cell->said();
  EXPECT_TRUE(cell->slave->says("no reading for 0.5 s", seconds(1))) << cell->said();
  dark.emplace_back(clock_s(), kNever_s);
  cell->plant->interrupt(SIGCONT);
  sleep_ms(500);
}

TEST_F(ProcessChaos, AKilledPlant) {
  begin();
  cell->plant->kill();
  EXPECT_EQ(cell->slave->wait(seconds(20)), 2) << cell->said();
  EXPECT_TRUE(cell->slave->says("slave: ", seconds(1))) << cell->said();
  EXPECT_TRUE(cell->master->running());
}

TEST_F(ProcessChaos, ALinkThatIsDownForAWhile) {
  const auto profile = Program::scratch() / "outage.toml";
  std::ofstream(profile) << "[both]\ndelay_ms = 20\n[[event]]\nfirst_s = 12\nduration_ms = 1000\nloss = "
                            "1.0\n[[event]]\nfirst_s = 22\nduration_ms = 5000\nloss = 1.0\n";
  begin({.all = {"--netem", profile.string()}});
  for (int n = 0; n < 2; ++n) {  // 1 s, 5 s
    const auto silences = [&] {
      int count = 0;
      const std::string said = cell->slave->output(), word = "no commands arrive";
      for (std::size_t at = said.find(word); at != said.npos; at = said.find(word, at + 1)) ++count;
      return count;
    };
    const int before = silences();
    for (int i = 0; i < 1500 && silences() == before; ++i) sleep_ms(10);
    ASSERT_GT(silences(), before) << cell->said();
    const double down_s = clock_s();
    sleep_ms(n == 0 ? 2000 : 6000);
    dark_until_engaged(down_s);
  }
}

TEST_F(ProcessChaos, ALinkThatIsDownOnTheWayToTheSlaveAlone) {
  const auto profile = Program::scratch() / "one-way.toml";
  std::ofstream(profile) << "[both]\ndelay_ms = 20\n[[event]]\nfirst_s = 12\nduration_ms = 2000\nloss = 1.0\n"
                            "direction = \"forward\"\n";
  begin({.all = {"--netem", profile.string()}});
  const std::string followed = "engaged: the slave follows";
  ASSERT_TRUE(cell->slave->says("no commands arrive", seconds(20))) << cell->said();
  const double down_s = clock_s();
  sleep_ms(3000);
  const std::string said = cell->master->output();
  EXPECT_GT(said.find("the slave does not follow", said.rfind(followed)), said.rfind(followed))
      << "it no longer says that the slave follows\n"
      << said;
  dark_until_engaged(down_s);
}

TEST_F(ProcessChaos, AMasterThatIsStartedAnewAtOnce) {
  begin();
  cell->master->interrupt();
  EXPECT_EQ(cell->master->wait(seconds(10)), 0) << cell->said();
  const double ended_s = clock_s() + 0.3;
  cell->flags.master = {"--button", "pressed"};
  cell->start_master();
  ASSERT_TRUE(cell->master->says("guiding the hand", seconds(10))) << cell->said();
  dark_until_engaged(ended_s);
}

TEST_F(ProcessChaos, AFullDisk) {
  const auto full = Program::scratch() / "full";
  std::filesystem::create_directories(full);
  if (std::system(("mount -t tmpfs -o size=64k tmpfs '" + full.string() + "' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "no file system can be mounted here";
  begin({.slave = {"--record", (full / "record").string(), "--stop-file", (full / "stops").string()}});
  std::ofstream(full / "rest") << std::string(100'000, ' ');
  still_lit();
  EXPECT_EQ(cell->tell({"stop"}), 0) << "obeyed, kept or not";
  dark.emplace_back(clock_s(), kNever_s);
  cell->slave->interrupt();
  EXPECT_EQ(cell->slave->wait(seconds(20)), 2) << "its record could not be written\n" << cell->said();
  EXPECT_EQ(std::system(("umount '" + full.string() + "'").c_str()), 0);
}

TEST_F(ProcessChaos, ASecondMasterAndASecondSlave) {
  begin();
  Program master("telekerf-master",
                 cell->in_cell({"--engage", "--button", "pressed", "--name", "second"}, {}));
  Program slave("telekerf-slave", cell->in_cell({"--name", "other"}, {}));
  EXPECT_EQ(master.wait(seconds(20)), 2) << master.output();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  still_lit();
}

TEST_F(ProcessChaos, AForger) {
  begin();
  Bus bus(stranger());
  Reader<CommandBlock> heard(bus);
  Writer<CommandBlock> said(bus);
  ASSERT_TRUE(said.wait_for_reader(seconds(10)));
  codec::StreamSettings codec;
  codec.integrated = true;
  experiments::Forger forger(codec);
  experiments::BirthRegister births;
  experiments::FaultWindow window;
  for (window.word = 0; window.word < 3;
       ++window.word) {  // the last number, the farthest, one more each time
    window.from_s = clock_s();
    std::vector<experiments::Datagram> out;
    for (; clock_s() < window.from_s + 3.0; sleep_ms(1)) {
      while (const auto block = heard.take()) forger.saw(block->value);
      if (clock_s() > window.from_s + 0.5) forger.step(monotonic_ns(), window, births, out);
      for (const auto& datagram : out) (void)said.write(datagram.block);
      out.clear();
    }
    sleep_ms(1500);  // whoever followed a forger hears the true master again
    EXPECT_EQ(cell->tell({"disengage"}), 0);
    sleep_ms(500);
    const int before = cell->lights_said();
    EXPECT_EQ(cell->tell({"engage"}), 0);
    EXPECT_TRUE(cell->lit(before)) << "the true master is heard again\n" << cell->said();
  }
}

TEST_F(ProcessChaos, ATapeThatIsPlayedWhileTheMasterIsAway) {
  begin();
  Bus bus(stranger());
  Reader<CommandBlock> heard(bus);
  Writer<CommandBlock> said(bus);
  ASSERT_TRUE(said.wait_for_reader(seconds(10)));
  experiments::Replayer replayer;
  const double from_s = clock_s();
  for (; clock_s() < from_s + 2.0; sleep_ms(1))
    while (const auto block = heard.take()) replayer.saw(monotonic_ns(), block->value);
  cell->master->interrupt(SIGSTOP);
  const double away_s = clock_s() + 0.3;
  experiments::BirthRegister births;
  experiments::FaultWindow window;
  for (window.word = 0; window.word < 3; ++window.word) {  // as it was, under another epoch, renumbered
    window.from_s = clock_s();
    std::vector<experiments::Datagram> out;
    for (; clock_s() < window.from_s + 2.5; sleep_ms(1)) {
      replayer.step(monotonic_ns(), window, births, out);
      for (const auto& datagram : out) (void)said.write(datagram.block);
      out.clear();
    }
  }
  dark.emplace_back(away_s, clock_s());
  cell->master->interrupt(SIGCONT);
  sleep_ms(1500);  // whoever followed a tape hears the true master again
  dark_until_engaged(away_s);
}

TEST_F(ProcessChaos, AFloodOfEvents) {
  begin();
  Bus bus(stranger());
  Writer<EventMessage> said(bus);
  ASSERT_TRUE(said.wait_for_reader(seconds(10), 1));
  std::atomic<bool> over = false;
  std::jthread flood([&] {
    EventMessage event;
    event.kind = EventMessage::Kind::kSetBeta;
    event.value = 0.5;
    while (!over) (void)said.write(event);
  });
  still_lit();
  EXPECT_EQ(cell->tell({"stop"}), 0) << cell->said();
  const double stopped_s = clock_s();
  sleep_ms(500);
  over = true;
  flood.join();
  EXPECT_EQ(cell->tell({"clear-stop"}), 0) << cell->said();
  sleep_ms(3000);
  dark_until_engaged(stopped_s);
}

}  // namespace
}  // namespace telekerf::integration
