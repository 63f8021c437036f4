// SPDX-License-Identifier: Apache-2.0
// The file of a run: written beside a loop, finished, left by a killed process, damaged.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

#include "common/recording/recording.h"
#include "common/recording/rows.h"
#include "common/recording/run_reader.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class RecordingFile : public testing::Test {
 protected:
  RecordingFile()
      : folder_(fs::temp_directory_path() / ("telekerf-recording-" + std::to_string(::getpid()))),
        file_(folder_ / "master.h5") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~RecordingFile() override { fs::remove_all(folder_); }

  static RunIdentity identity() {
    RunIdentity identity{.role = "master", .program = "test", .cell = "cell-1", .epoch = 7};
    date_now(identity);
    identity.settings = "beta = 0.5\n";
    identity.words["law"] = "local";
    identity.figures["beta"] = 0.1;
    return identity;
  }
  static std::vector<Recording::Part> parts() {
    return {{schema_of("master", master_columns(), true), 1000.0}};
  }
  static MasterRow row(std::uint64_t tick) {
    std::mt19937_64 random(tick);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    MasterRow row;
    row.tick = tick;
    row.t_s = static_cast<double>(tick) * 1e-3;
    row.tool_m = 1e-5 * Vec3(any(random), any(random), any(random));
    row.hand_n = Vec3(any(random), -0.0, any(random));
    row.guided = tick % 3 == 0;
    row.force_tick = tick % 7 == 0 ? -1.0 : static_cast<double>(tick);
    row.beta = any(random);
    return row;
  }
  static void expect_rows(const RunReader& reader, std::uint64_t count) {
    const auto data = reader.data("master");
    ASSERT_TRUE(data);
    const auto rows = rows_of(*data, master_columns());
    ASSERT_EQ(rows.size(), count);
    for (std::uint64_t n = 0; n < count; ++n) {
      const MasterRow expected = row(n);
      for (const auto& column : master_columns()) {
        const double was = column.read(expected);
        const double is = column.read(rows[n]);
        ASSERT_EQ(std::memcmp(&was, &is, sizeof was), 0) << column.name << " of row " << n;
      }
    }
  }
  /// Rows of a child that is killed after `after`, told through a pipe when it was begun; returns what it
  /// said last to be acknowledged and pushed.
  struct Killed {
    std::uint64_t acknowledged = 0;
    std::uint64_t pushed = 0;
  };
  Killed kill_after(milliseconds after) {
    fs::remove(file_);
    int words[2];
    EXPECT_EQ(::pipe(words), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      Recording recording(file_, identity(), parts(), [](const std::string&) {});
      recording.add(RunContour{.id = 3, .mode = "outline", .source = "heart", .points_m = {{0, 0}, {1, 2}}});
      for (std::uint64_t tick = 0;; ++tick) {
        recording.ring(0).push(master_columns(), row(tick));
        const std::uint64_t said[2] = {recording.acknowledged(), tick + 1};
        if (::write(words[1], said, sizeof said) < 0) ::_exit(1);
        ::usleep(200);
      }
    }
    ::close(words[1]);
    std::uint64_t said[2] = {};
    Killed killed;
    const auto end = std::chrono::steady_clock::now() + after;
    bool alive = true;
    while (::read(words[0], said, sizeof said) == sizeof said) {
      killed = {said[0], said[1]};
      if (alive && std::chrono::steady_clock::now() >= end) {
        ::kill(child, SIGKILL);
        alive = false;
      }
    }
    ::close(words[0]);
    ::waitpid(child, nullptr, 0);
    return killed;
  }

  fs::path folder_, file_;
};

TEST_F(RecordingFile, IsFinishedWithEveryRowBitForBit) {
  {
    Recording recording(file_, identity(), parts(), [](const std::string& said) { ADD_FAILURE() << said; });
    for (std::uint64_t tick = 0; tick < 5000; ++tick) {
      recording.ring(0).push(master_columns(), row(tick));
      if (tick % 100 == 0) std::this_thread::sleep_for(milliseconds(1));
    }
    recording.add(RunEvent{1.5, 12, "said", 0.25, "engaged: the slave follows"});
    recording.add(RunContour{9, false, 4, 2.5, 1e-4, 2e-6, "stroke", "heart", {{0.1, 0.2}, {-0.3, 0.4}}});
    const auto kept = recording.close({.figures = {{"rtt_p50_ms", 100.125}}, .words = {{"image", "heart"}}});
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->series[0].rows, 5000U);
    EXPECT_EQ(kept->series[0].gaps, 0U);
    EXPECT_EQ(kept->series[0].non_finite, 0U);
    EXPECT_EQ(recording.dropped(), 0U);
  }
  const RunReader reader(file_);
  EXPECT_EQ(reader.state(), RunState::kClosed);
  EXPECT_EQ(reader.identity().settings, "beta = 0.5\n");
  EXPECT_EQ(reader.identity().epoch, 7U);
  EXPECT_EQ(reader.identity().figures.at("beta"), 0.1);
  EXPECT_EQ(reader.identity().figures.at("rtt_p50_ms"), 100.125);
  EXPECT_EQ(reader.identity().words.at("law"), "local");
  EXPECT_EQ(reader.identity().words.at("image"), "heart");
  expect_rows(reader, 5000);
  const auto events = reader.events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].text, "engaged: the slave follows");
  EXPECT_EQ(events[0].tick, 12);
  EXPECT_EQ(events[0].value, 0.25);
  const auto contours = reader.contours();
  ASSERT_EQ(contours.size(), 1U);
  EXPECT_EQ(contours[0].source, "heart");
  EXPECT_FALSE(contours[0].closed);
  EXPECT_EQ(contours[0].points_m, (std::vector<Vec2>{{0.1, 0.2}, {-0.3, 0.4}}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing else is left";
}

TEST_F(RecordingFile, CountsDroppedRowsAtTheSeriesThatLacksThem) {
  // The files' order of the two is not the one that they are given in.
  const std::vector<Recording::Part> two = {{schema_of("slave", master_columns(), true), 1.0},
                                            {schema_of("blocks", master_columns(), true), 1.0}};
  std::uint64_t dropped = 0;
  RunIdentity slave = identity();
  slave.role = "slave";
  {
    Recording recording(file_, slave, two, [](const std::string&) {});
    for (std::uint64_t tick = 0; tick < 5000; ++tick) recording.ring(0).push(master_columns(), row(tick));
    for (std::uint64_t tick = 0; tick < 10; ++tick) recording.ring(1).push(master_columns(), row(tick));
    ASSERT_TRUE(recording.close({}));
    dropped = recording.dropped();
  }
  ASSERT_GT(dropped, 0U);
  const RunReader reader(file_);
  for (const RunReader::Series& series : reader.series()) {
    const bool lacks = series.schema.name == "slave";
    EXPECT_EQ(series.dropped_rows, lacks ? dropped : 0U) << series.schema.name;
    EXPECT_EQ(series.rows + series.dropped_rows, lacks ? 5000U : 10U) << series.schema.name;
  }
}

TEST_F(RecordingFile, OfAKilledProcessNoRowIsLost) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 12; ++trial) {
    const Killed killed = kill_after(milliseconds(20 + random() % 400));
    {
      const RunReader left(file_);
      EXPECT_EQ(left.state(), RunState::kRecording);
      EXPECT_FALSE(left.writer()) << "it is gone";
      EXPECT_GE(left.series()[0].rows, killed.acknowledged);
      EXPECT_LE(killed.pushed - std::min(killed.pushed, left.series()[0].rows), 500U) << "100 ms at 5 kHz";
    }
    const RunKept kept = finish_run_file(file_, {.state = RunState::kRecovered});
    EXPECT_EQ(kept.damaged_rows, 0U);
    EXPECT_GE(kept.rows(), killed.pushed) << "with the memory that it left nothing is";
    const RunReader reader(file_);
    EXPECT_EQ(reader.state(), RunState::kRecovered);
    expect_rows(reader, kept.rows());
    EXPECT_EQ(RunReader(folder_ / "flight-master-killed.h5").data("master")->rows(), kept.rows())
        << "the last ten seconds are all of it";
    if (killed.acknowledged > 0) {
      EXPECT_EQ(reader.contours().size(), 1U);
    }
  }
  for (const auto& entry : fs::directory_iterator("/dev/shm"))
    EXPECT_EQ(entry.path().filename().string().find("telekerf-master-" + std::to_string(::getpid())),
              std::string::npos);
}

TEST_F(RecordingFile, WithoutTheMemoryAKilledProcessLosesATenthOfASecond) {
  for (int trial = 0; trial < 5; ++trial) {
    const Killed killed = kill_after(milliseconds(150 + 70 * trial));
    for (const RunReader reader(file_); const auto& series : reader.series()) fs::remove(series.ring);
    const RunKept kept = finish_run_file(file_, {.state = RunState::kRecovered});
    EXPECT_EQ(kept.rows_from_memory, 0U);
    EXPECT_GE(kept.rows(), killed.acknowledged);
    EXPECT_LE(killed.pushed, kept.rows() + 500) << "100 ms at 5 kHz";
    expect_rows(RunReader(file_), kept.rows());
  }
}

TEST_F(RecordingFile, AuditFindsGapsJumpsAndWhatIsNoNumber) {
  std::vector<MasterRow> rows;
  for (std::uint64_t tick : {0, 1, 2, 5, 6, 7}) rows.push_back({.tick = tick});
  rows[4].tool_m.x() = 0.01;
  rows[5].tool_m.x() = 0.01;
  rows[5].hand_n.z() = std::nan("");
  ClosedFile file(file_, identity(), RunState::kClosed);
  const SeriesData data = series_of<MasterRow>("master", master_columns(), rows, true);
  file.append(file.add(data.schema), data.numbers);
  const auto audit = file.finish();
  ASSERT_EQ(audit.size(), 1U);
  EXPECT_EQ(audit[0].gaps, 1U);
  EXPECT_EQ(audit[0].missing_ticks, 2U);
  EXPECT_EQ(audit[0].jumps, 1U);
  EXPECT_EQ(audit[0].non_finite, 1U);
}

TEST_F(RecordingFile, WhatComesWhileTheDiskIsFullIsWrittenWhenThereIsRoomAgain) {
  std::atomic<std::uint64_t> free_bytes{1U << 20U};
  {
    Recording recording(
        file_, identity(), parts(), [](const std::string&) {},
        [&](const fs::path&) -> std::optional<std::uint64_t> { return free_bytes.load(); });
    std::this_thread::sleep_for(milliseconds(200));
    recording.add(RunContour{.id = 5, .mode = "outline", .source = "heart", .points_m = {{0, 0}, {1, 2}}});
    recording.add(RunEvent{1.5, 12, "said", 0.0, "engaged"});
    std::this_thread::sleep_for(milliseconds(200));
    free_bytes = std::uint64_t{1} << 40U;
    std::this_thread::sleep_for(milliseconds(1300));
    recording.ring(0).push(master_columns(), row(0));
    ASSERT_TRUE(recording.close({}));
  }
  const RunReader reader(file_);
  ASSERT_EQ(reader.contours().size(), 1U);
  EXPECT_EQ(reader.contours()[0].id, 5U);
  ASSERT_EQ(reader.events().size(), 1U);
  EXPECT_EQ(reader.events()[0].text, "engaged");
}

TEST_F(RecordingFile, WhatIsLostToAFullDiskIsSaidOnceASecond) {
  std::vector<std::string> said;  // by the recorder's thread, until it is closed
  const auto begun = std::chrono::steady_clock::now();
  std::uint64_t dropped = 0;
  {
    Recording recording(
        file_, identity(), parts(), [&](const std::string& sentence) { said.push_back(sentence); },
        [](const fs::path&) -> std::optional<std::uint64_t> { return 1U << 20U; });
    for (std::uint64_t tick = 0; std::chrono::steady_clock::now() - begun < milliseconds(2500); ++tick) {
      recording.ring(0).push(master_columns(), row(tick));
      std::this_thread::sleep_for(milliseconds(5));
    }
    (void)recording.close({});
    dropped = recording.dropped();
  }
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  EXPECT_EQ(std::count_if(said.begin(), said.end(),
                          [](const std::string& s) { return s.find("the disk is full") != s.npos; }),
            1);
  const auto lost = std::count_if(said.begin(), said.end(),
                                  [](const std::string& s) { return s.find("rows are not in") != s.npos; });
  EXPECT_GE(lost, 1);
  EXPECT_LE(static_cast<double>(lost), took_s + 1.0);
  EXPECT_GT(dropped, 100U);
}

TEST_F(RecordingFile, OfTwoProcessesOneRecordsAndTheOtherIsRefused) {
  Recording first(file_, identity(), parts(), [](const std::string&) {});
  try {
    const Recording second(file_, identity(), parts(), [](const std::string&) {});
    FAIL() << "it overwrites the first one's record";
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what()).find("another process records into it"), std::string::npos)
        << error.what();
  }
}

TEST_F(RecordingFile, AFaultWritesTheLastSeconds) {
  std::string said;
  {
    Recording recording(file_, identity(), parts(), [&](const std::string& sentence) { said += sentence; });
    for (std::uint64_t tick = 0; tick < 300; ++tick) recording.ring(0).push(master_columns(), row(tick));
    recording.fault("emergency stop");
    (void)recording.close({});
  }
  EXPECT_NE(said.find("emergency stop"), std::string::npos);
  const RunReader flight(folder_ / "flight-master-1.h5");
  EXPECT_EQ(flight.events().at(0).text, "emergency stop");
  EXPECT_GE(flight.data("master")->rows(), 299U);
  EXPECT_EQ(RunReader(file_).events().at(0).kind, "fault");
}

TEST_F(RecordingFile, WhatIsNoRecordingIsRefusedAndDamageHangsNobody) {
  const auto refused = [&] {
    try {
      const RunReader reader(file_);
    } catch (const StartupError& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused().find("it is not there"), std::string::npos);
  std::ofstream(file_) << "no HDF5";
  EXPECT_NE(refused().find("it is no HDF5 file"), std::string::npos);
  { const h5::Id file = h5::create_file(file_, false); }
  EXPECT_NE(refused().find("no recording of a run"), std::string::npos);
}

TEST(RowRing, OverwritesTheOldestAndSaysWhatIsMissing) {
  RowRing ring(2, 8);
  for (double n = 0; n < 20; ++n) ring.push(std::vector<double>{n, -n});
  std::vector<double> out;
  const std::uint64_t first = ring.copy(0, 100, out);
  EXPECT_EQ(first, 13U) << "the oldest slot is the producer's";
  ASSERT_EQ(out.size(), 14U);
  EXPECT_EQ(out.front(), 13.0);
  EXPECT_EQ(out.back(), -19.0);
  out.clear();
  EXPECT_EQ(ring.copy(18, 1, out), 18U);
  EXPECT_EQ(out, (std::vector<double>{18.0, -18.0}));
}

TEST(RowRing, NoRowIsTornWhileTheProducerRuns) {
  RowRing ring(8, 64);
  std::jthread producer([&](const std::stop_token& stop) {
    std::vector<double> row(8);
    for (double n = 0; !stop.stop_requested(); ++n) {
      row.assign(8, n);
      ring.push(row);
    }
  });
  std::uint64_t taken = 0;
  std::vector<double> out;
  while (taken < 200'000) {
    out.clear();
    taken = ring.copy(taken, 32, out);
    for (std::size_t at = 0; at < out.size(); at += 8)
      for (std::size_t c = 0; c < 8; ++c) ASSERT_EQ(out[at + c], static_cast<double>(taken + at / 8));
    taken += out.size() / 8;
  }
}

TEST(Quantities, VectorsAreOneAndUnitsGo) {
  const auto names = [](const auto& columns) {
    std::string all;
    for (const Quantity& quantity : quantities_of(schema_of("x", columns)))
      all += quantity.name + (quantity.count > 1 ? std::to_string(quantity.count) : "") + " ";
    return all;
  };
  EXPECT_EQ(names(master_columns()),
            "tick time tool3 hand3 constraint guided engaged button predicted3 joined force_tick "
            "slave_force3 beta ");
  EXPECT_EQ(names(slave_columns()), "tick time applied_tick ref3 tool3 laser interlock settled force3 ");
}

}  // namespace
}  // namespace telekerf
