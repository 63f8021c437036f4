// SPDX-License-Identifier: Apache-2.0
// A recording that is no longer what was written: refused with the place, never another report.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "common/recording/closed_file.h"
#include "common/recording/row_judge.h"
#include "common/recording/rows.h"
#include "common/recording/run_match.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

class DamagedFile : public testing::Test {
 protected:
  DamagedFile()
      : folder_(fs::temp_directory_path() / ("telekerf-damaged-" + std::to_string(::getpid()))),
        file_(folder_ / "slave.h5") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~DamagedFile() override { fs::remove_all(folder_); }

  static SeriesData rows(const std::string& role, std::size_t count) {
    std::mt19937_64 random(3);
    std::vector<SlaveRow> rows(count);
    for (std::size_t n = 0; n < count; ++n) {
      rows[n].tick = n;
      rows[n].t_s = 5.0 + 1e-3 * static_cast<double>(n);
      rows[n].tool_m.x() = 1e-9 * static_cast<double>(random() % 1000);
    }
    return series_of<SlaveRow>(role, slave_columns(), rows, true);
  }
  static void write(const fs::path& file, const RunIdentity& identity, std::size_t count, double x_m = 0.0) {
    ClosedFile to(file, identity, RunState::kClosed);
    const SeriesData data = rows(identity.role, count);
    to.append(to.add(data.schema), data.numbers);
    to.append(RunContour{.id = 3, .points_m = {{x_m, 0.0}, {1.0, 2.0}}});
    (void)to.finish();
  }
  static RunIdentity identity(const std::string& role = "slave") {
    RunIdentity identity{.role = role, .cell = "cell-1", .epoch = 7};
    identity.figures["beta"] = 0.1;
    return identity;
  }
  static std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  template <typename Work>
  static std::string refusal_of(Work work) {
    try {
      work();
    } catch (const StartupError& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      return error.what();
    }
    return "none";
  }

  fs::path folder_, file_;
};

/// What a reader would take for the run, in order.
std::string told(const RunReader& reader) {
  std::string all = reader.identity().cell;
  for (const auto& [name, figure] : reader.identity().figures) all += name + std::to_string(figure);
  for (const auto& series : reader.series()) {
    const auto data = reader.data(series.schema.name);
    for (const double number : data->numbers)
      all.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  for (const RunContour& contour : reader.contours())
    for (const Vec2& point : contour.points_m) all += std::to_string(point.x()) + std::to_string(point.y());
  return all;
}

TEST_F(DamagedFile, AFlippedBitIsRefusedOrChangesNothing) {
  write(file_, identity(), 300);
  const std::string was = told(RunReader(file_));
  const std::string bytes = bytes_of(file_);
  std::mt19937_64 random(22);
  int refused = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const std::size_t at = random() % bytes.size();
    std::string other = bytes;
    other[at] = static_cast<char>(other[at] ^ (1 << (random() % 8)));
    std::ofstream(file_, std::ios::binary) << other;
    if (refusal_of([&] { probe_recording(file_); }) != "none") {
      ++refused;
      continue;
    }
    EXPECT_TRUE(told(RunReader(file_)) == was) << "byte " << at;
  }
  EXPECT_GT(refused, 50);
}

TEST_F(DamagedFile, ADamagedChunkIsNamed) {
  write(file_, identity(), 5000);
  haddr_t at = 0;
  hsize_t size = 0;
  {
    const h5::Id open = h5::open_file(file_);
    const h5::Id tool(H5Dopen2(open.get(), "slave/tool", H5P_DEFAULT), "no data set");
    const hsize_t row[2] = {4096, 0};
    unsigned filters = 0;
    ASSERT_GE(H5Dget_chunk_info_by_coord(tool.get(), row, &filters, &at, &size), 0);
  }
  std::string bytes = bytes_of(file_);
  bytes[at + size / 2] = static_cast<char>(bytes[at + size / 2] ^ 1);
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_NE(
      refusal_of([&] { const RunReader reader(file_); }).find("slave/tool: rows 4096 to 4999 are damaged"),
      std::string::npos);
}

TEST_F(DamagedFile, AMissingDataSetIsNamed) {
  write(file_, identity(), 10);
  {
    const h5::Id open(H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "no file");
    h5::set_count(open.get(), "unused", 1);  // also what is added is seen
  }
  EXPECT_NE(refusal_of([&] { const RunReader reader(file_); }).find("checksum"), std::string::npos);
  {
    const h5::Id open(H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "no file");
    ASSERT_GE(H5Adelete(open.get(), "format_version"), 0);
    h5::set_count(open.get(), "format_version", run_file::kVersionWithoutSum);
    ASSERT_GE(H5Ldelete(open.get(), "slave/laser", H5P_DEFAULT), 0);
  }
  EXPECT_NE(refusal_of([&] { const RunReader reader(file_); }).find("its data set slave/laser is missing"),
            std::string::npos);
}

TEST_F(DamagedFile, MissingFolderAndCutOffAreThreeSentences) {
  EXPECT_NE(refusal_of([&] { const RunReader reader(file_); }).find("it is not there"), std::string::npos);
  EXPECT_NE(refusal_of([&] { const RunReader reader(folder_); }).find("it is a folder"), std::string::npos);
  write(file_, identity(), 300);
  fs::resize_file(file_, fs::file_size(file_) / 2);
  EXPECT_NE(refusal_of([&] { const RunReader reader(file_); }).find("cut off or damaged"), std::string::npos);
}

TEST_F(DamagedFile, SitesOfTwoRunsAreNotMerged) {
  write(folder_ / "master.h5", identity("master"), 10);
  const auto judged = [&](const RunIdentity& slave, double x_m) {
    write(file_, slave, 10, x_m);
    return refusal_of([&] { refuse_unrelated(RunReader(folder_ / "master.h5"), RunReader(file_)); });
  };
  EXPECT_EQ(judged(identity(), 0.0), "none");
  EXPECT_NE(judged(identity(), 0.5).find("contour 3 is another one there"), std::string::npos);
  RunIdentity other = identity();
  other.cell = "cell-2";
  EXPECT_NE(judged(other, 0.0).find("cell cell-1 and cell cell-2"), std::string::npos);
  other = identity();
  other.utc_at_zero_ns = 86'400'000'000'000;
  EXPECT_NE(judged(other, 0.0).find("apart in time"), std::string::npos);
}

TEST_F(DamagedFile, VisionOfAnotherRunIsNotMergedEither) {
  write(folder_ / "master.h5", identity("master"), 10);
  const std::vector<fs::path> folders{folder_};
  const auto judged = [&](const RunIdentity& vision) {
    write(folder_ / "vision.h5", vision, 10);
    return refusal_of([&] { refuse_unrelated(folders); });
  };
  EXPECT_EQ(judged(identity("vision")), "none");
  RunIdentity other = identity("vision");
  other.utc_at_zero_ns += 480'000'000'000;
  EXPECT_NE(judged(other).find("vision.h5: are not of the same run: they are 475 s apart"), std::string::npos) << judged(other);
  other = identity("vision");
  other.virtual_time = true;
  EXPECT_NE(judged(other).find("virtual time"), std::string::npos);
  other = identity("vision");
  other.cell = "cell-2";
  EXPECT_NE(judged(other).find("cell cell-1 and cell cell-2"), std::string::npos);
}

TEST_F(DamagedFile, RowsThatCannotBeAreCutOff) {
  const SeriesData data = rows("slave", 100);
  const std::size_t width = data.schema.width();
  const auto gone = [&](auto&& damage) {
    std::vector<double> numbers = data.numbers;
    damage(numbers);
    return RowJudge(data.schema).keep_possible(numbers);
  };
  EXPECT_EQ(gone([](std::vector<double>&) {}), 0U);
  EXPECT_EQ(gone([&](auto& n) { std::fill(n.begin() + 40 * width, n.begin() + 60 * width, 0.0); }), 21U)
      << "and the one before, which may be half of itself";
  EXPECT_EQ(gone([&](auto& n) { n[50 * width] = 5000.0; }), 1U) << "a tick that the next does not go on from";
  EXPECT_EQ(gone([&](auto& n) { n[50 * width + 1] = 1.0; }), 1U) << "time runs back";
  EXPECT_EQ(gone([&](auto& n) { n.erase(n.begin() + 40 * width, n.begin() + 60 * width); }), 0U)
      << "a gap that the run itself had";
}

}  // namespace
}  // namespace telekerf
