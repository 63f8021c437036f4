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
            10696798966989498531U);
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
  traffic.packets = 10'000;  // goes on after the end
  for (const auto& report : verify(replay, traffic)) EXPECT_TRUE(report.good());
}

/// A recording of 100 packets a second, met by streams of other rates.
TEST(Trace, IsReplayedByTimeAndNotByPacket) {
  DirectionProfile profile;
  profile.recording = std::make_shared<Recording>(Recording{
      {0, 5'000'000}, {10'000'000, 0, true}, {20'000'000, 7'000'000, false, true}, {30'000'000, 9'000'000}});
  const auto fates = [&](std::int64_t step_ms, int packets) {
    Emulator emulator(profile, {1});
    std::string text;
    for (int i = 0; i < packets; ++i) {
      const std::int64_t now_ns = i * step_ms * 1'000'000;
      const PacketOutcome outcome = emulator.push(now_ns, 10U, 0);
      text += outcome.lost()
                  ? std::string(outcome.after_trace ? "-" : "x")
                  : std::to_string((outcome.due_ns - now_ns) / 1'000'000) + (outcome.duplicated ? "d" : "");
      text += ' ';
    }
    return text;
  };
  EXPECT_EQ(fates(10, 5), "5 x 7d 9 - ");
  EXPECT_EQ(fates(5, 9), "5 5 x x 7d 7d 9 9 - ");
  EXPECT_EQ(fates(20, 3), "5 7d - ");
  profile.trace_end = TraceEnd::kRepeat;
  EXPECT_EQ(fates(10, 9), "5 x 7d 9 5 x 7d 9 5 ");
  EXPECT_EQ(fates(30, 5), "5 9 7d x 5 ");
  // Packets that were recorded at the same time are met one after the other, then the last.
  profile.recording = std::make_shared<Recording>(Recording{{0, 1'000'000}, {0, 2'000'000}, {0, 3'000'000}});
  EXPECT_EQ(fates(0, 5), "1 2 3 3 3 ");
  profile.recording = std::make_shared<Recording>(Recording{{4'000'000, 1'000'000}, {6'000'000, 2'000'000}});
  EXPECT_EQ(fates(2, 9), "1 1 1 2 1 1 1 2 1 ");
}

TEST(Trace, AnEndIsSaidAndNothingGetsThroughAfterIt) {
  const File file(text_of(record(load_profile("hostile").forward, {5}, 3'000)));
  const Profile replay = load_profile(file.path);
  EXPECT_EQ(
      trace_note(replay),
      "forward is recorded for 3 s, then nothing gets through (trace_end = \"repeat\" begins it anew); "
      "backward is recorded for 3 s, then nothing gets through (trace_end = \"repeat\" begins it anew)");
  EXPECT_EQ(trace_note(load_profile("hostile")), "");
  Emulator emulator(replay.forward, {1});
  EXPECT_FALSE(emulator.push(2'999'500'000, 10U, 0).after_trace);
  EXPECT_TRUE(emulator.push(3'000'000'000, 10U, 0).after_trace);
  EXPECT_EQ(emulator.counters().after_trace, 1U);
  const Profile losses = parse_profile(
      "[both]\ndelay_ms = 7\nloss_model = \"trace\"\nloss_trace = \"" + file.path + "\"", "test");
  Emulator ended(losses.forward, {1});
  EXPECT_TRUE(ended.push(3'000'000'000, 10U, 0).after_trace);
  const Profile round =
      parse_profile("[both]\ntrace = \"" + file.path + "\"\ntrace_end = \"repeat\"", "test");
  EXPECT_EQ(trace_note(round),
            "forward is recorded for 3 s, then it begins anew; backward is recorded for 3 s, "
            "then it begins anew");
  Traffic traffic;
  traffic.packets = 10'000;  // goes round more than three times
  for (const auto& report : verify(round, traffic)) EXPECT_TRUE(report.good());
  traffic.rate_hz = 333.0;
  for (const auto& report : verify(round, traffic)) EXPECT_TRUE(report.good()) << "at another rate";
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
  for (const auto& [text, named] :
       {std::pair<std::string, std::string>{"", "line 1"},
        {"a,b\n", "line 1"},
        {header, "no packet"},
        {header + "0,0,5,0,0\n", "line 2"},
        {header + "0,0,5,0,0,0,0\n", "line 2"},
        {header + "0,0,x,0,0,0\n", "line 2"},
        {header + "0,0,5,2,0,0\n", "line 2"},
        {header + "1,0,5,0,0,0\n", "line 2"},
        {header + "0,9,5,0,0,0\n", "line 2"},
        {header + "0,9,10,0,0,0\n1,8,10,0,0,0\n", "line 3"},
        {header + "0,-9,10,0,0,0\n", "line 2"},
        {header + "0,1000000000000000001,1000000000000000002,0,0,0\n", "10^18"},
        {header + "0,18446744073709551616,18446744073709551616,0,0,0\n", "line 2"}}) {
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
