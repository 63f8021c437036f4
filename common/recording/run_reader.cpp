// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>

#include "common/recording/run_cells.h"
#include "common/recording/run_process.h"
#include "common/runtime/startup_error.h"

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
  for (const RunState state : {RunState::kClosed, RunState::kRecovered})
    if (word == word_of(state)) return state;
  return RunState::kRecording;
}

}  // namespace

RunReader::RunReader(const std::filesystem::path& file) {
  const std::lock_guard alone(h5::library());
  try {
    file_ = h5::open_file(file);
    if (h5::text_of(file_.get(), "format") != run_file::kFormat)
      throw h5::Failure("it is HDF5, but no recording of a run");
    if (const auto version = h5::number_of(file_.get(), "format_version"); version != run_file::kVersion)
      throw h5::Failure("its format is of another version of Telekerf");
    state_ = state_of(file_.get());
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
      if (H5Aexists(group.get(), "columns") <= 0) continue;
      Series series{run_file::read_schema(group.get(), name), 0, h5::text_of(group.get(), "ring").value_or(""), 0};
      if (series.schema.columns.empty()) throw h5::Failure("a series has no columns");
      series.dropped_rows =
          static_cast<std::uint64_t>(h5::number_of(group.get(), "dropped_rows").value_or(0));
      const std::string dataset = h5::has(group.get(), "rows") ? "rows" : quantities_of(series.schema)[0].name;
      series.rows = h5::rows_of(open_dataset(group.get(), dataset).get());
      series_.push_back(std::move(series));
    }
  } catch (const h5::Failure& failure) {
    throw input_error(fmt::format("{}: cannot be read as a recording: {}", file.string(), failure.what()));
  }
}

RunReader::~RunReader() {
  const std::lock_guard alone(h5::library());
  file_.close();
}

bool RunReader::read(std::size_t index, std::uint64_t first, std::uint64_t rows,
                     std::vector<double>& out) const {
  const std::lock_guard alone(h5::library());
  const Series& series = series_[index];
  const std::size_t width = series.schema.width();
  const std::size_t before = out.size();
  try {
    const h5::Id group(H5Gopen2(file_.get(), series.schema.name.c_str(), H5P_DEFAULT), "a group is missing");
    out.resize(before + rows * width);
    if (h5::has(group.get(), "rows")) {
      if (h5::read_rows(open_dataset(group.get(), "rows").get(), H5T_NATIVE_DOUBLE, width, first, rows,
                        out.data() + before))
        return true;
      throw h5::Failure("damaged");
    }
    std::vector<double> part;
    for (const Quantity& quantity : quantities_of(series.schema)) {
      part.resize(rows * quantity.count);
      if (!h5::read_rows(open_dataset(group.get(), quantity.name).get(), H5T_NATIVE_DOUBLE, quantity.count,
                         first, rows, part.data()))
        throw h5::Failure("damaged");
      for (std::uint64_t n = 0; n < rows; ++n)
        for (std::size_t c = 0; c < quantity.count; ++c)
          out[before + n * width + quantity.first + c] = part[n * quantity.count + c];
    }
    return true;
  } catch (const h5::Failure&) {
    out.resize(before);
    return false;
  }
}

std::optional<SeriesData> RunReader::data(const std::string& name) const {
  for (std::size_t index = 0; index < series_.size(); ++index) {
    if (series_[index].schema.name != name) continue;
    SeriesData data{series_[index].schema, {}};
    const std::uint64_t all = series_[index].rows;
    data.numbers.reserve(all * data.schema.width());
    for (std::uint64_t first = 0; first < all; first += kRowsAtOnce)
      (void)read(index, first, std::min(kRowsAtOnce, all - first), data.numbers);
    return data;
  }
  return std::nullopt;
}

std::vector<RunEvent> RunReader::events() const {
  const std::lock_guard alone(h5::library());
  std::vector<RunEvent> events;
  try {
    for (const auto& cell : cells_in<run_file::EventCell>(file_.get(), "events", run_file::event_type())) events.push_back(run_file::event_of(cell));
  } catch (const h5::Failure&) {
    return {};
  }
  return events;
}

std::vector<RunContour> RunReader::contours() const {
  const std::lock_guard alone(h5::library());
  std::vector<RunContour> contours;
  try {
    const h5::Id points = open_dataset(file_.get(), "contours/points");
    const std::uint64_t there = h5::rows_of(points.get());
    for (const auto& cell : cells_in<run_file::ContourCell>(file_.get(), "contours/list", run_file::contour_type())) {
      RunContour contour = run_file::contour_of(cell);
      if (cell.first > there || cell.count > there - cell.first) continue;
      std::vector<double> numbers(2 * cell.count);
      if (!h5::read_rows(points.get(), H5T_NATIVE_DOUBLE, 2, cell.first, cell.count, numbers.data())) continue;
      for (std::size_t n = 0; n < cell.count; ++n)
        contour.points_m.emplace_back(numbers[2 * n], numbers[2 * n + 1]);
      contours.push_back(std::move(contour));
    }
  } catch (const h5::Failure&) {
    return {};
  }
  return contours;
}

}  // namespace telekerf
