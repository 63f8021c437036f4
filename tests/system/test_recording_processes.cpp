// SPDX-License-Identifier: Apache-2.0
// Recordings of the real processes: killed, recovered, reported, labelled.
#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>

#include "common/recording/rows.h"
#include "common/recording/run_reader.h"
#include "common/runtime/clock.h"
#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> cell(std::vector<std::string> more) {
  std::vector<std::string> all = {"--domain", own_domain(), "--cell", "record"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

int inspect(std::vector<std::string> words, std::string* said = nullptr) {
  Program program("telekerf-inspect", words);
  const int code = program.wait(seconds(60));
  if (said != nullptr) *said = program.output();
  return code;
}

/// More by the environment: TELEKERF_KILLS=1000.
int kills() {
  const char* asked = std::getenv("TELEKERF_KILLS");
  return asked == nullptr ? 5 : std::atoi(asked);
}

TEST(RecordingProcesses, AKilledSlaveLosesLessThanATenthOfASecond) {
  std::mt19937 random(22);
  double longest_s = 0.0, sum_s = 0.0;
  const int trials = kills();
  for (int trial = 0; trial < trials; ++trial) {
    const fs::path folder = Program::scratch() / ("killed-" + std::to_string(trial));
    const fs::path file = folder / "slave.h5";
    Program slave("telekerf-slave", cell({"--record", folder.string()}));
    ASSERT_TRUE(slave.says("ready", seconds(20))) << slave.output();
    std::this_thread::sleep_for(milliseconds(200 + random() % 500));
    std::string said;
    if (trial == 0) {
      EXPECT_EQ(inspect({"recover", folder.string()}, &said), 2) << said;
      EXPECT_NE(said.find("still records into it"), std::string::npos) << said;
    }
    const double killed_s = 1e-9 * static_cast<double>(monotonic_ns());
    slave.interrupt(SIGKILL);
    EXPECT_NE(slave.wait(seconds(5)), 0);
    if (trial % 2 == 1) {  // as after a reboot: the file alone
      const RunReader left(file);
      for (const auto& series : left.series()) fs::remove(series.ring);
    }
    ASSERT_EQ(inspect({"recover", file.string()}, &said), trial % 2)
        << "without the memory nobody knows the end: " << said;
    const RunReader reader(file);
    EXPECT_EQ(reader.state(), RunState::kRecovered);
    const auto rows = rows_of(*reader.data("slave"), slave_columns());
    ASSERT_FALSE(rows.empty());
    for (std::size_t n = 0; n < rows.size(); ++n) ASSERT_EQ(rows[n].tick, n);
    const double lost_s = killed_s - rows.back().t_s;
    EXPECT_LE(lost_s, 0.1) << "kill " << trial;
    longest_s = std::max(longest_s, lost_s);
    sum_s += lost_s;
    EXPECT_EQ(fs::exists(folder / "flight-slave-killed.h5"), trial % 2 == 0);
    EXPECT_EQ(inspect({"recover", folder.string()}, &said), 0) << "and again is nothing to do: " << said;
    if (!HasFailure()) fs::remove_all(folder);
  }
  std::printf("%d kills: lost %.4f s in the mean, %.4f s at the most\n", trials, sum_s / trials, longest_s);
}

TEST(RecordingProcesses, VisionAndConsoleRecordWhatTheyPublishedAndHeard) {
  const fs::path folder = Program::scratch() / "others";
  {
    Program vision("telekerf-vision", cell({"--image", "heart", "--record", folder.string()}));
    Program console("telekerf-console", cell({"--port", "0", "--record", folder.string()}));
    ASSERT_TRUE(vision.says("points", seconds(20))) << vision.output();
    ASSERT_TRUE(console.says("http://", seconds(20))) << console.output();
    Program choose("telekerf-ctl", cell({"choose", "mode outline"}));
    EXPECT_EQ(choose.wait(seconds(20)), 0) << choose.output();
    std::this_thread::sleep_for(milliseconds(1500));
    vision.interrupt(SIGKILL);
    EXPECT_NE(vision.wait(seconds(5)), 0);
    console.interrupt();
    ASSERT_EQ(console.wait(seconds(10)), 0) << console.output();
  }
  std::string said;
  EXPECT_EQ(inspect({"recover", (folder / "vision.h5").string()}, &said), 0) << said;
  const RunReader vision(folder / "vision.h5");
  EXPECT_EQ(vision.identity().program, "telekerf-vision");
  EXPECT_EQ(vision.state(), RunState::kRecovered);
  const auto contours = vision.contours();
  ASSERT_EQ(contours.size(), 2u) << "the strokes, then the outlines that were asked for";
  EXPECT_EQ(contours[0].mode, "stroke");
  EXPECT_EQ(contours[1].mode, "outline");
  EXPECT_EQ(vision.data("operator")->rows(), 1u);
  EXPECT_GE(vision.data("telemetry")->rows(), 1u);
  const RunReader console(folder / "console.h5");
  EXPECT_EQ(console.state(), RunState::kClosed);
  const auto events = console.events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const RunEvent& e) {
    return e.text.find("http://") != e.text.npos;
  })) << "what it said is in its record";
}

TEST(RecordingProcesses, TheReportOfTwoSitesIsThatOfTheirText) {
  const fs::path folder = Program::scratch() / "sites";
  const std::string here = (folder / "master").string();
  const std::string there = (folder / "slave").string();
  const std::string out = (folder / "out").string();
  {
    Program vision("telekerf-vision", cell({"--image", "heart"}));
    Program slave("telekerf-slave", cell({"--record", there, "--netem", "lindbergh"}));
    Program master("telekerf-master",
                   cell({"--record", here, "--netem", "lindbergh", "--engage", "--duration-s", "4"}));
    ASSERT_EQ(master.wait(seconds(60)), 0) << master.output() << slave.output() << vision.output();
    slave.interrupt();
    EXPECT_EQ(slave.wait(seconds(20)), 0) << slave.output();
  }
  std::string said;
  EXPECT_EQ(inspect({"run", here}, &said), 2);
  EXPECT_NE(said.find("holds no slave.h5"), std::string::npos) << said;
  ASSERT_EQ(inspect({"label", here, "good", "a clean cut"}, &said), 0) << said;
  ASSERT_EQ(inspect({"run", here, there, "--csv", "--out", out}, &said), 0) << said;
  EXPECT_NE(said.find("good: a clean cut"), std::string::npos) << said;
  // What the processes wrote themselves at their end, and the report that comes of it.
  for (const char* file : {"master.csv", "master.json", "contour.csv", "contour.json"})
    EXPECT_EQ(text_of(fs::path(out) / file), text_of(fs::path(here) / file)) << file;
  for (const char* file : {"slave.csv", "slave.json"})
    EXPECT_EQ(text_of(fs::path(out) / file), text_of(fs::path(there) / file)) << file;
  ASSERT_EQ(inspect({"run", out}, &said), 0) << said;
  const std::string report = text_of(fs::path(out) / "report.json");
  ASSERT_EQ(inspect({"run", here, there, "--out", (folder / "again").string()}, &said), 0) << said;
  EXPECT_EQ(text_of(folder / "again" / "report.json"), report);
  EXPECT_EQ(text_of(folder / "again" / "trace.csv"), text_of(fs::path(out) / "trace.csv"));
  const RunReader master(fs::path(here) / "master.h5");
  EXPECT_NE(master.identity().settings.find("duration_s = 4"), std::string::npos);
  EXPECT_GT(master.data("blocks")->rows(), 300U);
  EXPECT_GT(master.data("telemetry")->rows(), 100U);
  EXPECT_EQ(master.contours().size(), 1U);
  const auto events = master.events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const RunEvent& event) { return event.text == "engaged: the slave follows"; }));
  // The network of the replay is that of the run, block by block.
  Program replay("telekerf-experiment", {"replay", here, there, "--out", (folder / "replay").string()});
  ASSERT_EQ(replay.wait(seconds(60)), 0) << replay.output();
  const auto rtt_ms = [&](const std::string& json) {
    return nlohmann::json::parse(json)["link"]["rtt_ms"]["p50"].get<double>();
  };
  EXPECT_GT(rtt_ms(report), 150.0);
  EXPECT_NEAR(rtt_ms(text_of(folder / "replay" / "report.json")), rtt_ms(report), 0.05 * rtt_ms(report));
}

TEST(RecordingProcesses, EveryRunIsRecordedBelowOutUnlessAFolderIsNamed) {
  const fs::path here = Program::scratch() / "unnamed";
  fs::create_directories(here);
  Program slave("/bin/sh",
                {"-c", "cd " + here.string() + " && exec " TELEKERF_BIN_DIR "/telekerf-slave --domain " +
                           own_domain() + " --cell record"});
  ASSERT_TRUE(slave.says("ready", seconds(20))) << slave.output();
  EXPECT_TRUE(slave.says("slave: recorded in out/", seconds(1))) << slave.output();
  slave.interrupt();
  EXPECT_EQ(slave.wait(seconds(10)), 0) << slave.output();
  std::size_t files = 0;
  for (const auto& folder : fs::directory_iterator(here / "out")) {
    EXPECT_EQ(RunReader(folder.path() / "slave.h5").state(), RunState::kClosed);
    EXPECT_FALSE(fs::exists(folder.path() / "slave.csv")) << "text is for those who have named a folder";
    ++files;
  }
  EXPECT_EQ(files, 1U);
}

TEST(RecordingProcesses, NothingIsRecordedWhereNobodyWantsIt) {
  Program slave("telekerf-slave", cell({"--record", "off"}));
  ASSERT_TRUE(slave.says("ready", seconds(20))) << slave.output();
  slave.interrupt();
  EXPECT_EQ(slave.wait(seconds(10)), 0);
  EXPECT_EQ(slave.output().find("recorded in"), std::string::npos) << slave.output();
}

}  // namespace
}  // namespace telekerf::integration
