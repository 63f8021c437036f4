// SPDX-License-Identifier: Apache-2.0
#include "common/recording/closed_file.h"

#include <hdf5_hl.h>

#include <cmath>
#include <mutex>
#include <utility>

#include "common/recording/draft.h"
#include "common/recording/run_cells.h"
#include "common/recording/run_content.h"

namespace telekerf {
namespace {

hid_t type_of(ColumnKind kind) {
  switch (kind) {
    case ColumnKind::kCount:
      return H5T_STD_U64LE;
    case ColumnKind::kInteger:
      return H5T_STD_I32LE;
    case ColumnKind::kYesNo:
      return H5T_STD_U8LE;
    case ColumnKind::kNumber:
      break;
  }
  return H5T_IEEE_F64LE;
}

}  // namespace

ClosedFile::ClosedFile(std::filesystem::path file, const RunIdentity& identity, RunState state)
    : place_(std::move(file)), draft_(draft_of(place_)) {
  const std::lock_guard alone(h5::library());
  file_ = h5::create_file(draft_, false);
  run_file::write_identity(file_.get(), identity, state);
  const h5::Id contours = h5::make_group(file_.get(), "contours");
  points_ = h5::make_dataset(contours.get(), "points", H5T_IEEE_F64LE, 2, true);
  h5::set_text(points_.get(), "units", "m");
  h5::set_text(points_.get(), "frame", "workpiece");
  h5::set_text(points_.get(), "axes", "x y");
}

ClosedFile::~ClosedFile() {
  const std::lock_guard alone(h5::library());
  close();
  std::error_code ignored;
  std::filesystem::remove(draft_, ignored);  // unless it has been put in place
}

void ClosedFile::close() {
  series_.clear();
  points_.close();
  file_.close();
}

std::size_t ClosedFile::add(const SeriesSchema& schema, Begin begin) {
  const std::lock_guard alone(h5::library());
  Series series{schema, h5::make_group(file_.get(), schema.name), begin, {}, {}, {}};
  series.audit.name = schema.name;
  run_file::write_schema(series.group.get(), schema);
  for (const Quantity& quantity : quantities_of(schema)) {
    const SeriesColumn& column = schema.columns[quantity.first];
    h5::Id dataset =
        h5::make_dataset(series.group.get(), quantity.name, type_of(column.kind), quantity.count, true);
    h5::set_text(dataset.get(), "units", column.unit.empty() ? "1" : column.unit);
    if (!column.frame.empty()) h5::set_text(dataset.get(), "frame", column.frame);
    if (!quantity.axes.empty()) h5::set_text(dataset.get(), "axes", quantity.axes);
    if (!column.sentence.empty()) h5::set_text(dataset.get(), "long_name", column.sentence);
    series.columns.push_back({std::move(dataset), quantity, column.kind});
  }
  series_.push_back(std::move(series));
  return series_.size() - 1;
}

void ClosedFile::append(std::size_t index, std::span<const double> numbers) {
  const std::lock_guard alone(h5::library());
  Series& series = series_[index];
  const std::size_t width = series.schema.width();
  const std::size_t rows = numbers.size() / width;
  look_at(series, numbers);
  std::vector<double> part;
  for (const Column& column : series.columns) {
    part.clear();
    for (std::size_t n = 0; n < rows; ++n)
      for (std::size_t c = 0; c < column.quantity.count; ++c)
        part.push_back(numbers[n * width + column.quantity.first + c]);
    h5::append(column.dataset.get(), H5T_NATIVE_DOUBLE, column.quantity.count, rows, part.data());
  }
}

void ClosedFile::look_at(Series& series, std::span<const double> numbers) {
  const std::size_t width = series.schema.width();
  for (std::size_t at = 0; at + width <= numbers.size(); at += width) {
    const auto row = numbers.subspan(at, width);
    for (std::size_t c = 0; c < width; ++c) {
      if (!std::isfinite(row[c])) ++series.audit.non_finite;
      const SeriesColumn& column = series.schema.columns[c];
      const bool first = series.last.empty();
      if (!series.schema.every_tick || (first && (series.begin == Begin::kAnywhere || column.name != "tick")))
        continue;
      const double step = row[c] - (first ? -1.0 : series.last[c]);
      if (column.name == "tick" && step != 1.0) {
        ++series.audit.gaps;
        if (step > 1.0) series.audit.missing_ticks += static_cast<std::uint64_t>(step) - 1;
      }
      if (column.name.starts_with("tool_") && column.unit == "m" && std::abs(step) > SeriesAudit::kJump_m)
        ++series.audit.jumps;
    }
    series.last.assign(row.begin(), row.end());
    ++series.audit.rows;
  }
}

void ClosedFile::append(const RunEvent& event) { run_cells::add(events_, run_file::cell_of(event)); }

void ClosedFile::append(const RunContour& contour) {
  const std::lock_guard alone(h5::library());
  run_cells::add(contours_, run_file::cell_of(contour, point_rows_));
  std::vector<double> numbers;
  for (const Vec2& point : contour.points_m) numbers.insert(numbers.end(), {point.x(), point.y()});
  h5::append(points_.get(), H5T_NATIVE_DOUBLE, 2, contour.points_m.size(), numbers.data());
  point_rows_ += contour.points_m.size();
}

void ClosedFile::set_dropped(std::size_t series, std::uint64_t rows) {
  const std::lock_guard alone(h5::library());
  h5::set_count(series_[series].group.get(), "dropped_rows", rows);
}

std::vector<SeriesAudit> ClosedFile::finish() {
  const std::lock_guard alone(h5::library());
  run_cells::write(file_.get(), "events", run_file::event_type().get(), events_);
  run_cells::write(file_.get(), "contours/list", run_file::contour_type().get(), contours_);
  std::vector<SeriesAudit> audits;
  for (Series& series : series_) {
    const hid_t group = series.group.get();
    const SeriesAudit& audit = series.audit;
    h5::set_count(group, "rows", audit.rows);
    h5::set_count(group, "gaps", audit.gaps);
    h5::set_count(group, "missing_ticks", audit.missing_ticks);
    h5::set_count(group, "non_finite", audit.non_finite);
    h5::set_count(group, "jumps", audit.jumps);
    // Tools find the axis of every quantity by these.
    std::vector<hid_t> scales;
    for (const Column& column : series.columns) {
      const std::string& name = column.quantity.name;
      if (name != "time" && name != "tick") continue;
      h5::check(H5DSset_scale(column.dataset.get(), name.c_str()), "an axis cannot be made");
      scales.push_back(column.dataset.get());
    }
    for (const Column& column : series.columns) {
      if (column.quantity.name == "time" || column.quantity.name == "tick") continue;
      for (const hid_t scale : scales)
        h5::check(H5DSattach_scale(column.dataset.get(), scale, 0), "an axis cannot be attached");
    }
    audits.push_back(audit);
  }
  run_content::write_sum(file_.get());
  h5::check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "the finished file cannot be written out");
  close();
  put_in_place(draft_, place_);
  return audits;
}

}  // namespace telekerf
