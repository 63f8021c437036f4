// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <sstream>

#include "common/recording/run_cells.h"
#include "common/recording/run_content.h"
#include "common/recording/run_process.h"

namespace telekerf {
namespace {

constexpr std::uint64_t kRowsAtOnce = 4096;

h5::Id open_dataset(hid_t file, const std::string& path) {
  return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), "a dataset is missing"};
}

template <typename Cell>
std::vector<Cell> cells_in(hid_t file, const char* name, const h5::Id& type) {
  const std::vector<std::byte> bytes = run_cells::read(file, name, type.get());
  std::vector<Cell> cells(bytes.size() / sizeof(Cell));
  std::memcpy(cells.data(), bytes.data(), cells.size() * sizeof(Cell));
  return cells;
}

RunState state_of(hid_t file) {
  const std::string word = h5::text_of(file, "state").value_or("");
  for (const RunState state : {RunState::kRecording, RunState::kClosed, RunState::kRecovered})
    if (word == word_of(state)) return state;
  throw h5::Failure("it does not say whether it was finished");
}

void count(std::uint64_t* damaged, std::uint64_t more) {
  if (damaged != nullptr) *damaged += more;
}

/// Points that follow each other at the very origin: a piece of a file that was never written reads as zeros.
bool has_hole(const std::vector<double>& points) {
  for (std::size_t at = 0; at + 4 <= points.size(); at += 2)
    if (std::all_of(&points[at], &points[at] + 4, [](double number) { return number == 0.0; })) return true;
  return false;
}

}  // namespace

RunReader::RunReader(const std::filesystem::path& file, Check check) : path_(file) {
  const std::lock_guard alone(h5::library());
  bool known = false;
  try {
    file_ = h5::open_file(file);
    if (h5::text_of(file_.get(), "format") != run_file::kFormat)
      throw h5::Failure("it is HDF5, but no recording of a run");
    const auto version = h5::number_of(file_.get(), "format_version");
    if (version != run_file::kVersion && version != run_file::kVersionWithoutSum)
      throw h5::Failure("its format is of another version of Telekerf");
    state_ = state_of(file_.get());
    known = state_ != RunState::kRecording;
    if (known && check == Check::kAll) {
      if (version == run_file::kVersion) {
        run_content::check_sum(file_.get());
      } else {
        (void)run_content::sum_of(file_.get());  // all of it can be read
      }
    }
    open(check);
  } catch (const h5::Failure& failure) {
    if (known) damaged(failure.what());
    throw input_error(fmt::format("{}: cannot be read as a recording: {}", file.string(), failure.what()));
  }
}

void RunReader::damaged(const std::string& what) const {
  throw DamagedRecording(ErrorKind::kInput,
                         fmt::format("{}: is damaged: {}; use another copy of it", path_.string(), what));
}

void RunReader::open(Check check) {
  identity_ = run_file::read_identity(file_.get());
  if (state_ == RunState::kRecording) writer_ = writing_process(file_.get());
  hsize_t groups = 0;
  h5::check(H5Gget_num_objs(file_.get(), &groups), "it cannot be listed");
  for (hsize_t n = 0; n < groups; ++n) {
    char name[64] = {};
    if (H5Gget_objname_by_idx(file_.get(), n, name, sizeof name) < 0 ||
        H5Gget_objtype_by_idx(file_.get(), n) != H5G_GROUP)
      continue;
    const h5::Id group(H5Gopen2(file_.get(), name, H5P_DEFAULT), "a group cannot be opened");
    if (H5Aexists(group.get(), "columns") > 0) add_series(group.get(), name);
  }
  if (state_ == RunState::kRecording) find_missing();
  if (state_ == RunState::kRecording || check == Check::kHead) return;
  // A robot's side without its rows would look like one that did nothing.
  for (const char* role : {"master", "slave"}) {
    const auto of_role = [&](const Series& series) { return series.schema.name == role; };
    if (identity_.role == role && std::none_of(series_.begin(), series_.end(), of_role))
      throw h5::Failure(fmt::format("its data set {} is missing", role));
  }
}

void RunReader::find_missing() {
  std::istringstream names(h5::text_of(file_.get(), run_file::kSeries).value_or(""));
  for (std::string name; names >> name;) {
    const auto is_it = [&name](const Series& series) { return series.schema.name == name; };
    if (std::none_of(series_.begin(), series_.end(), is_it)) missing_.push_back(name);
  }
}

void RunReader::add_series(hid_t group, const std::string& name) {
  Series series{run_file::read_schema(group, name), 0, h5::text_of(group, "ring").value_or(""), 0};
  if (series.schema.columns.empty()) throw h5::Failure("a series has no columns");
  series.dropped_rows = static_cast<std::uint64_t>(h5::number_of(group, "dropped_rows").value_or(0));
  if (h5::has(group, "rows")) {
    const h5::Id rows = open_dataset(group, "rows");
    series.rows = h5::rows_to_read(rows.get());
    if (h5::width_of(rows.get()) != series.schema.width())
      throw h5::Failure(fmt::format("{}/rows: has another number of columns than its head says", name));
    series_.push_back(std::move(series));
    return;
  }
  std::optional<double> said = h5::number_of(group, "rows");
  for (const Quantity& quantity : quantities_of(series.schema)) {
    const std::string path = fmt::format("{}/{}", name, quantity.name);
    if (!h5::has(group, quantity.name)) throw h5::Failure(fmt::format("its data set {} is missing", path));
    const h5::Id dataset = open_dataset(group, quantity.name);
    series.rows = h5::rows_to_read(dataset.get());
    if (h5::width_of(dataset.get()) != quantity.count)
      throw h5::Failure(fmt::format("{}: has another number of columns than its head says", path));
    if (!said) said = static_cast<double>(series.rows);
    if (static_cast<double>(series.rows) != *said)
      throw h5::Failure(fmt::format("{}: has {} rows of {}", path, series.rows, *said));
  }
  series_.push_back(std::move(series));
}

RunReader::~RunReader() {
  const std::lock_guard alone(h5::library());
  file_.close();
}

void RunReader::read_or_throw(std::size_t index, std::uint64_t first, std::uint64_t rows,
                              std::vector<double>& out) const {
  const Series& series = series_[index];
  const std::string& name = series.schema.name;
  const std::size_t width = series.schema.width();
  const std::size_t before = out.size();
  const h5::Id group(H5Gopen2(file_.get(), name.c_str(), H5P_DEFAULT), "a group is missing");
  out.resize(before + rows * width);
  if (h5::has(group.get(), "rows")) {
    if (!h5::read_rows(open_dataset(group.get(), "rows").get(), H5T_NATIVE_DOUBLE, width, first, rows,
                       out.data() + before))
      throw h5::Failure(h5::damaged_rows(name + "/rows", first, rows));
    return;
  }
  std::vector<double> part;
  for (const Quantity& quantity : quantities_of(series.schema)) {
    part.resize(rows * quantity.count);
    if (!h5::read_rows(open_dataset(group.get(), quantity.name).get(), H5T_NATIVE_DOUBLE, quantity.count,
                       first, rows, part.data()))
      throw h5::Failure(h5::damaged_rows(name + "/" + quantity.name, first, rows));
    for (std::uint64_t n = 0; n < rows; ++n)
      for (std::size_t c = 0; c < quantity.count; ++c)
        out[before + n * width + quantity.first + c] = part[n * quantity.count + c];
  }
}

bool RunReader::read(std::size_t index, std::uint64_t first, std::uint64_t rows,
                     std::vector<double>& out) const {
  const std::lock_guard alone(h5::library());
  const std::size_t before = out.size();
  try {
    read_or_throw(index, first, rows, out);
    return true;
  } catch (const h5::Failure&) {
    out.resize(before);
    return false;
  }
}

std::optional<std::pair<double, double>> RunReader::span_s(std::size_t index) const {
  const Series& series = series_[index];
  const auto& columns = series.schema.columns;
  const auto time =
      std::find_if(columns.begin(), columns.end(), [](const SeriesColumn& c) { return c.name == "t_s"; });
  std::vector<double> ends;
  if (series.rows == 0 || time == columns.end() || !read(index, 0, 1, ends) ||
      !read(index, series.rows - 1, 1, ends))
    return std::nullopt;
  const auto at = static_cast<std::size_t>(time - columns.begin());
  return std::pair{ends[at], ends[columns.size() + at]};
}

std::optional<SeriesData> RunReader::data(const std::string& name) const {
  for (std::size_t index = 0; index < series_.size(); ++index) {
    if (series_[index].schema.name != name) continue;
    SeriesData data{series_[index].schema, {}};
    const std::uint64_t all = series_[index].rows;
    data.numbers.reserve(all * data.schema.width());
    for (std::uint64_t first = 0; first < all; first += kRowsAtOnce) {
      const std::uint64_t rows = std::min(kRowsAtOnce, all - first);
      if (state_ == RunState::kRecording) {
        (void)read(index, first, rows, data.numbers);
        continue;
      }
      const std::lock_guard alone(h5::library());
      try {
        read_or_throw(index, first, rows, data.numbers);
      } catch (const h5::Failure& failure) {
        damaged(failure.what());
      }
    }
    return data;
  }
  return std::nullopt;
}

std::vector<RunEvent> RunReader::events(std::uint64_t* damaged_events) const {
  const std::lock_guard alone(h5::library());
  std::vector<RunEvent> events;
  try {
    for (const auto& cell : cells_in<run_file::EventCell>(file_.get(), "events", run_file::event_type()))
      events.push_back(run_file::event_of(cell));
  } catch (const h5::Failure& failure) {
    if (state_ != RunState::kRecording) damaged(failure.what());
    count(damaged_events, 1);
    return {};
  }
  if (state_ == RunState::kRecording)
    count(damaged_events, std::erase_if(events, [](const RunEvent& e) { return e.kind.empty(); }));
  return events;
}

std::vector<RunContour> RunReader::contours(std::uint64_t* damaged_contours) const {
  const std::lock_guard alone(h5::library());
  std::vector<RunContour> contours;
  try {
    const h5::Id points = open_dataset(file_.get(), "contours/points");
    const std::uint64_t there = h5::rows_to_read(points.get());
    for (const auto& cell :
         cells_in<run_file::ContourCell>(file_.get(), "contours/list", run_file::contour_type())) {
      RunContour contour = run_file::contour_of(cell);
      const bool inside = cell.first <= there && cell.count <= there - cell.first;
      std::vector<double> numbers(inside ? 2 * cell.count : 0);
      const bool read =
          inside && h5::read_rows(points.get(), H5T_NATIVE_DOUBLE, 2, cell.first, cell.count, numbers.data());
      const bool unfinished = state_ == RunState::kRecording;
      if (unfinished && (!read || contour.mode.empty() || has_hole(numbers))) {
        count(damaged_contours, 1);
        continue;
      }
      if (!read) throw h5::Failure(fmt::format("contours/points: those of contour {} are damaged", cell.id));
      for (std::size_t n = 0; n < cell.count; ++n)
        contour.points_m.emplace_back(numbers[2 * n], numbers[2 * n + 1]);
      contours.push_back(std::move(contour));
    }
  } catch (const h5::Failure& failure) {
    if (state_ != RunState::kRecording) damaged(failure.what());
    count(damaged_contours, 1);
    return {};
  }
  return contours;
}

}  // namespace telekerf
