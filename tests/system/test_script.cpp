// SPDX-License-Identifier: Apache-2.0
// ./telekerf from a folder that is not its own: what the user names is looked for where the user stands, and
// a refusal leaves nothing behind.
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <nlohmann/json.hpp>

#include "tests/system/machine_noise.h"
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

  Ended run(const std::string& words, const std::string& build = TELEKERF_BUILD_DIR) const {
    const std::string quoted = "'" + here_.string() + "'";
    const std::string command = "cd " + quoted + " && PATH=" + quoted +
                                "/no-build:\"$PATH\" CI= TELEKERF_BUILD='" + build +
                                "' '" TELEKERF_SCRIPT "' " + words + " >out.txt 2>err.txt </dev/null";
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
  const Ended demo = run(
      "demo --no-console --image 'ein Bild.png' --out 'aus gabe/1' --duration-s=3 --netem './mein netz.toml' "
      "--domain " +
      own_domain());
  EXPECT_EQ(demo.code, 0) << demo.out << demo.err;
  EXPECT_EQ(demo.err, "");
  for (const std::string file : {"report.json", "cut.png", "trace.csv", "master.csv", "slave.csv"})
    EXPECT_TRUE(fs::exists(here_ / "aus gabe/1" / file)) << file;
  const auto report = nlohmann::json::parse(text_of("aus gabe/1/report.json"));
  EXPECT_EQ(report.at("netem").get<std::string>(), "mein netz");
  EXPECT_LE(report.at("tracking").at("rms_um").get<double>(), slack_of(report) * 15.0) << demo.out;
  EXPECT_GE(report.at("cut").at("coverage").get<double>(), 0.1) << "3 s of hand motion";
  EXPECT_EQ(report.at("cut").at("energy_outside_corridor_j").get<double>(), 0.0);
  for (const auto& entry : fs::directory_iterator(here_ / "aus gabe/1"))
    EXPECT_FALSE(entry.is_directory()) << entry.path();
}

TEST_F(Script, APlantOfItsOwnKeepsTheBookOfTheLight) {
  const Ended demo = run(
      "demo --image circle --plant process --out plant --duration-s 2 --netem lan --domain " + own_domain());
  EXPECT_EQ(demo.code, 0) << demo.out << demo.err;
  EXPECT_NE(demo.out.find("plant: "), std::string::npos) << demo.out;
  const auto book = nlohmann::json::parse(text_of("plant/plant.json"));
  EXPECT_GT(book.at("energy_inside_j").get<double>(), 0.0) << demo.out;
  EXPECT_EQ(book.at("energy_outside_corridor_j").get<double>(), 0.0);
  const auto report = nlohmann::json::parse(text_of("plant/report.json"));
  EXPECT_NEAR(book.at("energy_inside_j").get<double>(), report.at("cut").at("energy_inside_j").get<double>(),
              0.1 * book.at("energy_inside_j").get<double>())
      << "the slave's own idea of it";
  EXPECT_FALSE(fs::exists(here_ / "plant/plant.txt"));
  const Ended refused = run("demo --plant nowhere --out none --domain " + own_domain());
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("must be one of here, process"), std::string::npos) << refused.err;
}

TEST_F(Script, ARefusedDemoLeavesNothing) {
  const Ended demo = run("demo --no-console --image nowhere.png --out new/run --domain " + own_domain());
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

TEST_F(Script, AProgramThatIsKilledIsNamedAndNothingOfAnEarlierRunStaysBeside) {
  fs::create_directories(here_ / "run");
  for (const std::string file : {"report.json", "result.json", "notes.txt"})
    std::ofstream(here_ / "run" / file) << "earlier";
  const std::string cell = "killed-" + std::to_string(::getpid());
  std::jthread end_of_it([&] {
    const auto ready = [&] { return text_of("out.txt").find("engaged") != std::string::npos; };
    for (int n = 0; n < 600 && !ready(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(std::system(("pkill -KILL -f 'telekerf-[s]lave.*" + cell + "'").c_str()), 0);
  });
  const Ended demo =
      run("demo --no-console --out run --netem none --cell " + cell + " --domain " + own_domain());
  EXPECT_EQ(demo.code, 2) << demo.out;
  EXPECT_EQ(demo.err, "telekerf: telekerf-slave was killed (signal 9): by somebody, or for want of memory\n");
  EXPECT_TRUE(fs::exists(here_ / "run/notes.txt"));
  EXPECT_TRUE(fs::exists(here_ / "run/master.json")) << "the master had time to write";
  EXPECT_TRUE(fs::exists(here_ / "run/slave.h5")) << "and what the slave had recorded survives";
  EXPECT_FALSE(fs::exists(here_ / "run/report.json"));
  EXPECT_FALSE(fs::exists(here_ / "run/result.json"));
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
  const auto result = nlohmann::json::parse(text_of("cut/result.json"));
  EXPECT_LE(result.at("contour_error_um").at("rms").get<double>(), 3.0) << cut.out;
  EXPECT_NEAR(result.at("tangential_speed").at("mean_mm_s").get<double>(), 50.0, 0.5);
}

TEST_F(Script, AMachinistSeesThePlanFirstAndCutsOneContourOfIt) {
  std::ofstream(here_ / "plate.svg")
      << R"(<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30" fill="none" stroke="black">
           <rect x="1" y="1" width="28" height="20"/><circle cx="8" cy="8" r="3"/><circle cx="20" cy="8" r="2"/></svg>)";
  const Ended plan = run("machine plate.svg --dry-run --out plan --domain " + own_domain());
  EXPECT_EQ(plan.code, 0) << plan.out << plan.err;
  EXPECT_NE(plan.out.find("  1        1     18.849  closed\n  2        2     12.566  closed\n"
                          "  3        0     96.000  closed\n127.4 mm to cut"),
            std::string::npos)
      << plan.out;
  EXPECT_TRUE(fs::exists(here_ / "plan/overlay.png"));
  // Nothing of another size lies beside the plan, not even hidden.
  for (const auto& file : fs::directory_iterator(here_ / "plan")) {
    const std::string name = file.path().filename();
    EXPECT_TRUE(name == "overlay.png" || name == "vision.h5") << name;
  }
  const Ended none = run("machine plate.svg --select 3 --out none --domain " + own_domain());
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("--select 3: there are the contours 0 to 2"), std::string::npos) << none.err;
  const Ended cut =
      run("machine plate.svg --select 2 --speed-mm-s 20 --no-framing --out cut --domain " + own_domain());
  EXPECT_EQ(cut.code, 0) << cut.out << cut.err;
  const auto result = nlohmann::json::parse(text_of("cut/result.json"));
  EXPECT_EQ(result.at("order"), nlohmann::json::array({2}));
  EXPECT_EQ(result.at("contours_cut").get<int>(), 1);
  EXPECT_NEAR(result.at("length_mm").get<double>(), 12.566, 0.01);
  EXPECT_EQ(result.at("burn").at("energy_outside_corridor_j").get<double>(), 0.0) << result.dump(1);
}

/// In place of the programs: each writes down the words that it is started with, one a line, and ends.
class ScriptFlags : public Script {
 protected:
  ScriptFlags() {
    fs::create_directories(here_ / "stubs/bin");
    for (const std::string picture : {"a b.png", "a.svg"}) std::ofstream(here_ / picture) << "is there";
    std::ofstream(here_ / "stubs/build.ninja");
    for (const std::string name : {"vision", "slave", "machine", "master", "console", "inspect"}) {
      const fs::path stub = here_ / "stubs/bin" / ("telekerf-" + name);
      std::ofstream(stub)
          << "#!/bin/sh\ncase \" $* \" in *' --describe-settings '* | *' --print-config '* | *' "
             "--help '*) exec '" TELEKERF_BIN_DIR "/telekerf-"
          << name << "' \"$@\" ;; esac\nprintf '%s\\n' \"$@\" >" << name << ".part\nmv " << name << ".part " << name
          << ".txt\n";
      // Whoever's end ends the others waits until they have written, too.
      if (name == "machine" || name == "master")
        std::ofstream(stub, std::ios::app)
            << "for n in $(seq 20); do [ -e vision.txt ] && break; sleep 0.1; done\nsleep 0.3\n";
      fs::permissions(stub, fs::perms::owner_all);
    }
  }

  Ended run(const std::string& words) const { return Script::run(words, (here_ / "stubs").string()); }

  /// Whether the program was started with `words`: a flag and its value, or a switch.
  bool has(const std::string& program, const std::string& words) const {
    std::string all = "\n" + text_of(program + ".txt");
    for (const char between : {'\n', '='}) std::replace(all.begin(), all.end(), between, ' ');
    return all.find(" " + words + " ") != std::string::npos;
  }
};

TEST_F(ScriptFlags, OfADemoGoToTheProgramThatKnowsThem) {
  const Ended demo =
      run("demo --no-console --image 'a b.png' --width-mm 30 --beta=0.25 --law local --block 8 --keep 2 "
          "--redundancy 0 "
          "--max-rms 1e-3 --codec raw --estimator none --force-keep 3 --force-max-rms 0 --stale-s 0.1 "
          "--hand-speed-mm-s 5 --seed 7 --cell blue --master-robot vertical --slave-robot asymmetric "
          "--master-seed 9 --domain 3 --vision-fit-all --beta 0.3 --out run");
  ASSERT_EQ(demo.code, 0) << demo.err;
  for (const std::string words : {"--image a b.png", "--width-mm 30", "--robot asymmetric", "--fit-all",
                                  "--cell blue", "--domain 3", "--netem thesis-constant", "--netem-seed 7"})
    EXPECT_TRUE(has("vision", words)) << words << text_of("vision.txt");
  for (const std::string words :
       {"--force-keep 3", "--force-max-rms 0", "--stale-s 0.1", "--robot asymmetric", "--seed 7",
        "--cell blue", "--domain 3", "--netem thesis-constant", "--netem-seed 7"})
    EXPECT_TRUE(has("slave", words)) << words << text_of("slave.txt");
  for (const std::string words : {"--beta 0.3", "--law local", "--block 8", "--keep 2", "--redundancy 0",
                                  "--max-rms 1e-3", "--codec raw", "--estimator none", "--hand-speed-mm-s 5",
                                  "--robot vertical", "--seed 9", "--duration-s 30", "--engage",
                                  "--cell blue", "--domain 3", "--netem thesis-constant", "--netem-seed 7"})
    EXPECT_TRUE(has("master", words)) << words << text_of("master.txt");
  EXPECT_NE(text_of("slave.txt").find("--record\nrun/.run-"), std::string::npos);
  for (const std::string flag : {"--block", "--keep", "--redundancy", "--codec"})
    EXPECT_FALSE(has("slave", flag)) << flag;
}

TEST_F(ScriptFlags, OfAMachineGoToTheProgramThatKnowsThem) {
  const Ended machine =
      run("machine a.svg --width-mm 30 --mode outline --robot vertical --seed 7 --laser-w 3 --out cut");
  ASSERT_EQ(machine.code, 0) << machine.err;
  for (const std::string words :
       {"--image a.svg", "--width-mm 30", "--mode outline", "--robot vertical", "--fit-all"})
    EXPECT_TRUE(has("vision", words)) << words << text_of("vision.txt");
  for (const std::string words : {"--seed 7", "--laser-w 3", "--robot vertical"})
    EXPECT_TRUE(has("machine", words)) << words << text_of("machine.txt");
  // Two at a time do not meet.
  EXPECT_NE(text_of("vision.txt").find("--cell=machine-"), std::string::npos);
}

TEST_F(ScriptFlags, AListGivenInPartsArrivesWholeAndIsLookedAtLikewise) {
  const Ended machine =
      run("machine 'a b.png' --at 1,2 --width-mm 30 --at=3,4 --select 0 --select 2 --width-mm 40 --not 5,6 "
          "--level 0.4 --dry-run --out cut");
  ASSERT_EQ(machine.code, 0) << machine.err;
  for (const std::string program : {"vision", "inspect"}) {
    for (const std::string words : {"--at 1,2 --at 3,4", "--not 5,6", "--width-mm 40", "--level 0.4"})
      EXPECT_TRUE(has(program, words)) << program << words << text_of(program + ".txt");
    EXPECT_FALSE(has(program, "--width-mm 30"));
  }
  EXPECT_TRUE(has("machine", "--select 0 --select 2")) << text_of("machine.txt");
  EXPECT_FALSE(has("inspect", "--fit-all"));
}

TEST_F(ScriptFlags, ByHandTheMasterHearsThePageAndNobodyElseEngages) {
  const Ended demo = run("demo --by-hand --port 48123 --token 12345678 --out cut");
  ASSERT_EQ(demo.code, 0) << demo.err;
  EXPECT_TRUE(has("master", "--hand browser:127.0.0.1:48123")) << text_of("master.txt");
  EXPECT_TRUE(has("master", "--duration-s 0")) << "until it is stopped";
  EXPECT_FALSE(has("master", "--engage"));
  EXPECT_TRUE(has("console", "--port 48123")) << text_of("console.txt");
  EXPECT_TRUE(has("console", "--token 12345678"));
  EXPECT_TRUE(has("console", "--netem thesis-constant")) << "it sees the slave as the master does";
}

TEST_F(ScriptFlags, WithoutAConsoleNoPageIsServed) {
  ASSERT_EQ(run("demo --no-console --out cut").code, 0);
  EXPECT_TRUE(has("master", "--engage"));
  EXPECT_FALSE(fs::exists(here_ / "console.txt"));
}

TEST_F(ScriptFlags, APortThatIsTakenIsSaid) {
  boost::asio::io_context context;
  const boost::asio::ip::tcp::acceptor somebody(context, {boost::asio::ip::address_v4::loopback(), 0});
  const std::string port = std::to_string(somebody.local_endpoint().port());
  const Ended demo = run("demo --port " + port + " --out cut");
  EXPECT_EQ(demo.code, 2);
  EXPECT_EQ(demo.err, "telekerf: demo: --port " + port +
                          ": this port is taken by another program; end that, or give another port\n");
}

TEST_F(ScriptFlags, ThatNobodyKnowsAreRefusedBeforeAnythingStarts) {
  for (const std::string words : {"demo --speed 3",
                                  "demo --beta 99",
                                  "demo --width-mm wide",
                                  "demo --law none",
                                  "demo heart",
                                  "demo --beta",
                                  "demo --robot r",
                                  "demo --name n",
                                  "demo --record r",
                                  "demo --slave-beta 1",
                                  "demo '--a]b' 1",
                                  "machine",
                                  "machine --seed 1",
                                  "machine heart --beta 1",
                                  "machine heart --image gear",
                                  "machine heart --vision-select 1",
                                  "machine heart --config c",
                                  "demo --netem mars",
                                  "demo --by-hand --no-console",
                                  "demo --port 0",
                                  "demo --hand mouse",
                                  "demo --slave-laser-w 99 --slave-laser-max-w 5",
                                  "help nothing",
                                  "test_nothing",
                                  "bench nothing",
                                  "check nothing"}) {
    const Ended refused = run(words);
    EXPECT_EQ(refused.code, 2) << words;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << words << refused.err;
    EXPECT_EQ(refused.out, "") << words;
    for (const std::string program : {"vision", "slave", "master"})
      EXPECT_FALSE(fs::exists(here_ / (program + ".txt"))) << words;
    EXPECT_FALSE(fs::exists(here_ / "out")) << words;
  }
}

TEST_F(Script, AskedForHelpItBuildsNothingAndInstallsNothing) {
  for (const std::string command : {"setup", "build", "demo", "machine", "test", "check", "bench"}) {
    const Ended help = run(command + " --help", (here_ / "nothing built").string());
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_NE(help.out.find("./telekerf " + command), std::string::npos) << command << help.out;
    EXPECT_EQ(help.out, run("help " + command, (here_ / "nothing built").string()).out) << command;
    EXPECT_FALSE(fs::exists(here_ / "nothing built"));
  }
  EXPECT_NE(run("help demo").out.find("--hand-speed-mm-s"), std::string::npos);  // of the master
  EXPECT_EQ(run("build everything").code, 2);
  const Ended version = run("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out, TELEKERF_VERSION "\n");
}

}  // namespace
}  // namespace telekerf::integration
