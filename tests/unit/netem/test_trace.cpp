// SPDX-License-Identifier: Apache-2.0
// Recorded traces: golden outcomes, round trip through a file, replay, and files that are none.
#include "netem/core/trace.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "common/runtime/startup_error.h"
#include "netem/verify/verify.h"
#include "tests/unit/netem/recorded.h"

namespace telekerf::netem {
namespace {

struct File {
  explicit File(const std::string& text)
      : path((std::filesystem::temp_directory_path() /
              ("telekerf-trace-" + std::to_string(fingerprint(text)) + ".csv"))
                 .string()) {
    std::ofstream(path) << text;
  }
  ~File() { std::filesystem::remove(path); }
  std::string path;
};

TEST(Trace, GoldenSeeds) {
  // Same seed, same outcome of every packet: on every machine, at every optimisation level, for ever.
  EXPECT_EQ(fingerprint(text_of(record(load_profile("hostile").forward, {1}, 20'000))), 6103764377518664199U);
  EXPECT_EQ(fingerprint(text_of(record(load_profile("leo").backward, {2, 0, Direction::kBackward}, 20'000))),
            15611169539660863760U);
  EXPECT_EQ(fingerprint(text_of(record(load_profile("thesis-tcp").forward, {3}, 20'000))),
            1130713730247682398U);
}

TEST(Trace, ThreadsChangeNothing) {
  const DirectionProfile profile = load_profile("hostile").forward;
  const std::string expected = text_of(record(profile, {7}, 5'000));
  std::vector<std::string> traces(4);
  std::vector<std::thread> threads;
  threads.reserve(traces.size());
  for (auto& trace : traces) threads.emplace_back([&] { trace = text_of(record(profile, {7}, 5'000)); });
  for (auto& thread : threads) thread.join();
  for (const auto& trace : traces) EXPECT_EQ(trace, expected);
  EXPECT_NE(text_of(record(profile, {8}, 5'000)), expected);
}

TEST(Trace, ReplayGivesTheRecordingAgain) {
  const File file(text_of(record(load_profile("hostile").forward, {5}, 3'000)));
  const Profile replay = load_profile(file.path);
  std::ifstream in(file.path);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  EXPECT_EQ(text_of(record(replay.forward, {99}, 3'000)), text);
  Traffic traffic;
  traffic.packets = 10'000;  // goes round more than three times
  for (const auto& report : verify(replay, traffic)) EXPECT_TRUE(report.good());
}

TEST(Trace, LossesAloneCanBeReplayed) {
  const Recording recording = record(load_profile("hostile").forward, {5}, 3'000);
  const File file(text_of(recording));
  const Profile profile = parse_profile(
      "[both]\ndelay_ms = 7\nloss_model = \"trace\"\nloss_trace = \"" + file.path + "\"", "test");
  const Recording replayed = record(profile.forward, {1}, 3'000);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    EXPECT_EQ(replayed[i].lost, recording[i].lost);
    EXPECT_EQ(replayed[i].delay_ns, replayed[i].lost ? 0 : 7'000'000);
  }
}

TEST(Trace, AStageMayEndTheRecordedLosses) {
  const Recording recording = record(load_profile("hostile").forward, {5}, 3'000);
  const File file(text_of(recording));
  const Profile profile =
      parse_profile("[both]\nloss_model = \"trace\"\nloss_trace = \"" + file.path +
                        "\"\n[[stage]]\nfrom_s = 1\n[stage.both]\nloss_model = \"none\"\n",
                    "test");
  const Recording replayed = record(profile.forward, {1}, 3'000);
  std::size_t lost_later = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    EXPECT_EQ(replayed[i].lost, i < 1'000 && recording[i].lost) << i;
    lost_later += i >= 1'000 && recording[i].lost;
  }
  EXPECT_GT(lost_later, 0U);
}

TEST(Trace, VerifyHoldsRecordedLossesAgainstTheRecording) {
  Recording recording = record(load_profile("hostile").forward, {5}, 500);
  const auto losses_of = [](const Recording& losses) {
    DirectionProfile profile;
    profile.stages[0].conditions.loss.model = LossModel::kTrace;
    profile.recording = std::make_shared<Recording>(losses);
    profile.loss_only = true;
    return profile;
  };
  const DirectionProfile nominal = losses_of(recording);
  Traffic traffic;
  traffic.packets = 2'000;
  EXPECT_TRUE(verify_direction(nominal, nominal, Direction::kForward, traffic).front().good());
  recording[77].lost = !recording[77].lost;
  EXPECT_FALSE(verify_direction(nominal, losses_of(recording), Direction::kForward, traffic).front().good());
}

TEST(Trace, DamagedFilesAreRefusedByLine) {
  const std::string header = std::string(kTraceHeader) + "\n";
  for (const auto& [text, named] : {std::pair<std::string, std::string>{"", "line 1"},
                                    {"a,b\n", "line 1"},
                                    {header, "no packet"},
                                    {header + "0,0,5,0,0\n", "line 2"},
                                    {header + "0,0,5,0,0,0,0\n", "line 2"},
                                    {header + "0,0,x,0,0,0\n", "line 2"},
                                    {header + "0,0,5,2,0,0\n", "line 2"},
                                    {header + "1,0,5,0,0,0\n", "line 2"},
                                    {header + "0,9,5,0,0,0\n", "line 2"},
                                    {header + "0,9,10,0,0,0\n1,8,10,0,0,0\n", "line 3"},
                                    {header + "0,-9,10,0,0,0\n", "line 2"}}) {
    const File file(text);
    try {
      load_recording(file.path);
      FAIL() << "accepted: " << text;
    } catch (const StartupError& refusal) {
      EXPECT_NE(std::string(refusal.what()).find(named), std::string::npos) << refusal.what();
    }
  }
}

}  // namespace
}  // namespace telekerf::netem
