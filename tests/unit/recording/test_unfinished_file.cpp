// SPDX-License-Identifier: Apache-2.0
// What a killed process has left, cut off or with holes: recovered as far as it goes, and never said to be
// all of it when it is not. What is written in place of a file is there whole or not at all.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <thread>

#include "common/recording/closed_file.h"
#include "common/recording/recording.h"
#include "common/recording/rows.h"
#include "common/recording/run_folder.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/recording/run_tables.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr const char* kNobody = "99999999";  // no process has such a number
constexpr std::uint64_t kRows = 3000;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class UnfinishedFile : public testing::Test {
 protected:
  UnfinishedFile()
      : folder_(fs::temp_directory_path() / ("telekerf-unfinished-" + std::to_string(::getpid()))),
        file_(folder_ / "master.h5") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~UnfinishedFile() override { fs::remove_all(folder_); }

  /// A process records kRows rows of every tick, a block each tenth, three events and a contour, and kills
  /// itself; some of the last rows are in its memory only.
  void leave_recording() {
    const pid_t child = ::fork();
    if (child == 0) {
      RunIdentity identity{.role = "master", .program = "test", .cell = "cell-1", .epoch = 7};
      Recording recording(file_, identity,
                          {{schema_of("master", master_columns(), true), 1000.0},
                           {schema_of("blocks", block_columns()), 100.0}},
                          [](const std::string&) {});
      RunContour contour{.id = 3, .mode = "outline", .source = "heart"};
      for (int n = 0; n < 2000; ++n) contour.points_m.emplace_back(1e-3 + 1e-6 * n, -2e-3);
      recording.add(contour);
      for (const char* text : {"ready", "engaged", "the cut begins"})
        recording.add(RunEvent{1.5, 12, "said", 0.25, text});
      const auto push = [&](std::uint64_t from, std::uint64_t to) {
        for (std::uint64_t tick = from; tick < to; ++tick) {
          const double at_s = 5.0 + 1e-3 * static_cast<double>(tick);
          recording.ring(0).push(master_columns(),
                                 {.tick = tick, .t_s = at_s, .tool_m = Vec3(1e-9 * at_s, 0.0, 1e-3)});
          if (tick % 10 == 0)
            recording.ring(1).push(block_columns(), BlockRow{.tick = tick, .t_s = at_s, .epoch = 7});
        }
      };
      push(0, kRows - 300);
      while (recording.acknowledged() < kRows - 300) std::this_thread::sleep_for(milliseconds(1));
      push(kRows - 300, kRows);
      ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(child, nullptr, 0);
  }

  fs::path folder_, file_;
};

/// All that a reader finds, in order.
std::string told(const fs::path& file) {
  const RunReader reader(file);
  std::string all;
  for (const auto& series : reader.series()) {
    const auto data = reader.data(series.schema.name);
    all += series.schema.name;
    for (const double number : data->numbers)
      all.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  for (const RunEvent& event : reader.events()) all += event.kind + event.text;
  for (const RunContour& contour : reader.contours())
    for (const Vec2& point : contour.points_m)
      all += std::to_string(point.x()) + " " + std::to_string(point.y());
  return all;
}

TEST_F(UnfinishedFile, CutOffOrWithHolesIsNeverSaidToBeWhole) {
  leave_recording();
  const std::string bytes = bytes_of(file_);
  std::map<fs::path, std::string> rings;
  for (const RunReader left(file_); const auto& series : left.series())
    rings[series.ring] = bytes_of(series.ring);
  ASSERT_EQ(rings.size(), 2U);
  std::string whole;
  std::mt19937_64 random(23);
  int said_whole = 0, kept_some = 0, refused = 0;
  constexpr std::size_t kPage = 4096;
  for (int trial = 0; trial < 100; ++trial) {
    std::string other = bytes;
    constexpr std::size_t kHead = 100;  // of trial 1: too short to be opened at all
    const std::size_t at = trial == 0 ? bytes.size() : trial == 1 ? kHead : random() % bytes.size();
    if (trial % 3 == 1) {
      other.resize(at);
    } else if (trial > 0) {
      const std::size_t first = at / kPage * kPage;
      const std::size_t count = kPage * (1 + random() % 12);
      for (std::size_t n = first; n < std::min(first + count, other.size()); ++n) other[n] = 0;
    }
    const bool changed = other != bytes;
    fs::remove(file_);
    std::ofstream(file_, std::ios::binary) << other;
    for (const auto& [ring, memory] : rings) std::ofstream(ring, std::ios::binary) << memory;
    std::string said;
    try {
      said = told_by_child(
          file_,
          [&]() -> std::string {
            const auto kept = recover_run_file(file_);
            return kept && kept->whole() ? "whole" : "bad";
          },
          std::chrono::seconds(10));
    } catch (const StartupError& error) {
      said = error.what();
      EXPECT_EQ(said.find("signal"), std::string::npos) << "trial " << trial << ", at " << at << ": " << said;
      EXPECT_TRUE(bytes_of(file_) == other) << "what cannot be recovered stays as it was: " << said;
      ++refused;
      continue;
    }
    if (trial == 0) {
      whole = told(file_);
      ASSERT_EQ(said, "whole");
      ASSERT_EQ(RunReader(file_).data("master")->rows(), kRows);
      continue;
    }
    ++(said == "whole" ? said_whole : kept_some);
    const bool same = told(file_) == whole;
    EXPECT_TRUE(same || said != "whole") << "trial " << trial << ", at " << at << " of " << bytes.size();
    EXPECT_TRUE(same || changed) << "trial " << trial;
  }
  for (const auto& [ring, memory] : rings) fs::remove(ring);
  EXPECT_GT(said_whole, 0) << "holes where nothing is";
  EXPECT_GT(kept_some, 10);
  EXPECT_GT(refused, 0);
}

TEST_F(UnfinishedFile, ATableThatHasVanishedIsMissed) {
  leave_recording();
  const std::string bytes = bytes_of(file_);
  std::map<fs::path, std::string> rings;
  for (const RunReader left(file_); const auto& series : left.series())
    rings[series.ring] = bytes_of(series.ring);
  int vanished = 0;
  // One bit in what the file says of the blocks, from their group's name on.
  for (std::size_t at = bytes.find("blocks"); at != std::string::npos; at = bytes.find("blocks", at + 1)) {
    for (const std::size_t on : {0U, 8U, 16U, 64U, 256U, 512U, 1024U, 2048U}) {
      std::string other = bytes;
      if (at + on >= other.size()) continue;
      other[at + on] ^= 4;
      fs::remove(file_);
      std::ofstream(file_, std::ios::binary) << other;
      for (const auto& [ring, memory] : rings) std::ofstream(ring, std::ios::binary) << memory;
      std::optional<RunKept> kept;
      try {
        kept = recover_run_file(file_);
      } catch (const StartupError&) {
        EXPECT_TRUE(bytes_of(file_) == other) << "what cannot be recovered stays as it was";
        continue;
      }
      ASSERT_TRUE(kept);
      if (kept->missing_series.empty()) {
        EXPECT_TRUE(RunReader(file_).data("blocks")) << "at " << at + on;
        continue;
      }
      EXPECT_FALSE(kept->whole());
      if (kept->missing_series != std::vector<std::string>{"blocks"}) continue;
      ++vanished;
      const RunReader recovered(file_);
      EXPECT_FALSE(recovered.data("blocks"));
      EXPECT_EQ(recovered.data("master")->rows(), kRows);
    }
  }
  for (const auto& [ring, memory] : rings) fs::remove(ring);
  EXPECT_GT(vanished, 0);
}

TEST_F(UnfinishedFile, RecoveredLeavesNoDraftOfItsOwn) {
  leave_recording();
  const auto draft = [&](const std::string& file, const std::string& process) {
    const fs::path place = folder_ / (file + "." + process + ".part");
    std::ofstream(place) << "half a file";
    return place;
  };
  const std::vector<fs::path> own = {draft("master.h5", kNobody), draft("flight-master-killed.h5", kNobody)};
  const std::vector<fs::path> others = {draft("slave.h5", kNobody), draft("flight-slave-1.h5", kNobody),
                                        draft("master.h5", std::to_string(::getppid())),
                                        draft("master.h5", "x"), draft("report.json", kNobody)};
  ASSERT_TRUE(recover_run_file(file_));
  for (const fs::path& place : own) EXPECT_FALSE(fs::exists(place)) << place;
  for (const fs::path& place : others) EXPECT_TRUE(fs::exists(place)) << place;
  (void)draft("master.h5", kNobody);
  EXPECT_FALSE(recover_run_file(file_)) << "it is finished already";
  EXPECT_FALSE(fs::exists(own.front())) << "and its draft goes all the same";
}

TEST_F(UnfinishedFile, RowsMissingBeforeTheFirstAreCounted) {
  std::vector<MasterRow> rows;
  for (std::uint64_t tick : {7, 8, 9}) rows.push_back({.tick = tick});
  const SeriesData data = series_of<MasterRow>("master", master_columns(), rows, true);
  const auto audit = [&](ClosedFile::Begin begin) {
    ClosedFile file(file_, {.role = "master"}, RunState::kClosed);
    file.append(file.add(data.schema, begin), data.numbers);
    return file.finish().at(0);
  };
  EXPECT_EQ(audit(ClosedFile::Begin::kAtFirstTick).gaps, 1U);
  EXPECT_EQ(audit(ClosedFile::Begin::kAtFirstTick).missing_ticks, 7U);
  EXPECT_EQ(audit(ClosedFile::Begin::kAnywhere).missing_ticks, 0U) << "the last seconds begin anywhere";
}

TEST_F(UnfinishedFile, ALabelIsThereOrNotButTheFileIsWhole) {
  leave_recording();
  ASSERT_TRUE(recover_run_file(file_));
  const std::string was = told(file_);
  std::mt19937_64 random(24);
  for (int trial = 0; trial < 30; ++trial) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (int n = 0;; ++n) label_run(folder_, {n % 2 == 0, "label " + std::to_string(n)});
    }
    std::this_thread::sleep_for(std::chrono::microseconds(2000 + random() % 30'000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ASSERT_NO_THROW(probe_recording(file_)) << "trial " << trial;
  }
  const fs::path before = folder_ / "before";
  fs::create_hard_link(file_, before);
  const std::string bytes = bytes_of(before);
  label_run(folder_, {false, "the last word"});
  EXPECT_TRUE(bytes_of(before) == bytes) << "written in place: a kill would have left half of it";
  EXPECT_TRUE(told(file_) == was);
  EXPECT_EQ(label_of(file_)->text, "the last word");
  EXPECT_FALSE(label_of(file_)->good);
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_FALSE(entry.path().string().ends_with(".part")) << entry.path();
}

/// The place of one bit without which a table vanishes from a file, sought in a copy.
std::optional<std::size_t> vital_place(const fs::path& file, const std::string& table) {
  const std::string bytes = bytes_of(file);
  const fs::path copy = file.string() + ".copy";
  std::optional<std::size_t> place;
  for (std::size_t from = bytes.find(table); from != std::string::npos; from = bytes.find(table, from + 1)) {
    for (std::size_t at = from; !place && at < std::min(from + 256, bytes.size()); at += 8) {
      std::string other = bytes;
      other[at] ^= 4;
      std::ofstream(copy, std::ios::binary) << other;
      try {
        if (!RunReader(copy).missing().empty()) place = at;
      } catch (const StartupError&) {
        continue;
      }
    }
  }
  fs::remove(copy);
  return place;
}

TEST_F(UnfinishedFile, OneThatWasSpoiledWhileItGrewIsNotFinishedAndItsMemoryStays) {
  for (const bool vanishes : {true, false}) {
    fs::remove(file_);
    std::string said;
    fs::path ring;
    {
      Recording recording(file_, {.role = "master", .program = "test", .cell = "cell-1", .epoch = 7},
                          {{schema_of("master", master_columns(), true), 1000.0},
                           {schema_of("blocks", block_columns()), 100.0}},
                          [&](const std::string& sentence) { said += sentence; });
      ring = recording.ring(0).file();
      recording.add(RunEvent{1.5, 12, "a-kind", 0.25, "a text"});
      for (std::uint64_t tick = 0; tick < 300; ++tick)
        recording.ring(0).push(master_columns(), {.tick = tick, .t_s = 1e-3 * static_cast<double>(tick)});
      while (recording.acknowledged() < 300) std::this_thread::sleep_for(milliseconds(1));
      std::string bytes = bytes_of(file_);
      const auto at = vanishes ? vital_place(file_, "blocks") : std::optional(bytes.find("a-kind"));
      ASSERT_TRUE(at && *at < bytes.size());
      bytes[*at] = vanishes ? static_cast<char>(bytes[*at] ^ 4) : '\0';
      std::fstream(file_, std::ios::binary | std::ios::in | std::ios::out)
          .seekp(static_cast<std::streamoff>(*at))
          .put(bytes[*at]);
      EXPECT_FALSE(recording.close({}));
    }
    EXPECT_NE(said.find(vanishes ? "is not finished: its data set blocks is missing"
                                 : "is not finished: 1 of its rows, events and contours are damaged"),
              std::string::npos)
        << said;
    EXPECT_TRUE(fs::exists(ring)) << "the last seconds are there for who recovers it";
    fs::remove(ring);
  }
}

TEST_F(UnfinishedFile, OfAnotherRoleThanItsNameSaysIsRefused) {
  Recording recording(file_, {.role = "master", .program = "test", .cell = "cell-1", .epoch = 7},
                      {{schema_of("master", master_columns(), true), 1000.0}}, [](const std::string&) {});
  recording.ring(0).push(master_columns(), {.tick = 0, .t_s = 0.5});
  ASSERT_TRUE(recording.close({}));
  fs::rename(file_, folder_ / "slave.h5");
  const std::vector<fs::path> folders{folder_};
  try {
    (void)recording_of("slave", folders);
    FAIL() << "a master's rows for a slave's";
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what()).find("is the recording of telekerf-master; name it master.h5 again"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace telekerf
