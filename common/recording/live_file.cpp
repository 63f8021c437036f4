// SPDX-License-Identifier: Apache-2.0
#include "common/recording/live_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <mutex>

#include "common/recording/run_process.h"

namespace telekerf {

LiveFile::LiveFile(const std::filesystem::path& file, const RunIdentity& identity,
                   const std::vector<Part>& parts) {
  const std::lock_guard alone(h5::library());
  file_ = h5::create_file(file, true);
  run_file::write_identity(file_.get(), identity, RunState::kRecording);
  write_process(file_.get());
  std::string names;
  for (const Part& part : parts) names += (names.empty() ? "" : " ") + part.schema.name;
  h5::set_text(file_.get(), run_file::kSeries, names);
  for (const Part& part : parts) {
    const h5::Id group = h5::make_group(file_.get(), part.schema.name);
    run_file::write_schema(group.get(), part.schema);
    h5::set_text(group.get(), "ring", part.ring.string());
    series_.push_back(
        {h5::make_dataset(group.get(), "rows", H5T_NATIVE_DOUBLE, part.schema.width(), false),
         part.schema.width(), 0});
  }
  event_type_ = run_file::event_type();
  contour_type_ = run_file::contour_type();
  events_ = h5::make_dataset(file_.get(), "events", event_type_.get(), 1, false);
  const h5::Id contours = h5::make_group(file_.get(), "contours");
  contours_ = h5::make_dataset(contours.get(), "list", contour_type_.get(), 1, false);
  points_ = h5::make_dataset(contours.get(), "points", H5T_NATIVE_DOUBLE, 2, false);
  h5::check(H5Fstart_swmr_write(file_.get()), "the file cannot be made safe against a kill (SWMR)");
  flush();
}

LiveFile::~LiveFile() {
  const std::lock_guard alone(h5::library());
  for (Series& one : series_) one.dataset.close();
  for (h5::Id* id : {&events_, &contours_, &points_, &event_type_, &contour_type_, &file_}) id->close();
}

void LiveFile::append(std::size_t part, std::span<const double> numbers) {
  const std::lock_guard alone(h5::library());
  Series& series = series_[part];
  const std::size_t rows = numbers.size() / series.width;
  h5::append(series.dataset.get(), H5T_NATIVE_DOUBLE, series.width, rows, numbers.data());
  series.rows += rows;
}

void LiveFile::append(const RunEvent& event) {
  const std::lock_guard alone(h5::library());
  const run_file::EventCell cell = run_file::cell_of(event);
  h5::append(events_.get(), event_type_.get(), 1, 1, &cell);
}

void LiveFile::append(const RunContour& contour) {
  const std::lock_guard alone(h5::library());
  const run_file::ContourCell cell = run_file::cell_of(contour, point_rows_);
  std::vector<double> numbers;
  for (const Vec2& point : contour.points_m) numbers.insert(numbers.end(), {point.x(), point.y()});
  h5::append(points_.get(), H5T_NATIVE_DOUBLE, 2, contour.points_m.size(), numbers.data());
  h5::append(contours_.get(), contour_type_.get(), 1, 1, &cell);
  point_rows_ += contour.points_m.size();
}

void LiveFile::flush() {
  const std::lock_guard alone(h5::library());
  h5::check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "what was recorded cannot be written out");
}

std::filesystem::path LiveFile::place(const std::filesystem::path& file) const {
  const std::lock_guard alone(h5::library());
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &handle) < 0 || handle == nullptr) return file;
  const int descriptor = *static_cast<const int*>(handle);  // of the driver "sec2", the one for plain files
  struct stat ours {}, found {};
  if (::fstat(descriptor, &ours) != 0) return file;
  if (::stat(file.c_str(), &found) == 0 && found.st_ino == ours.st_ino && found.st_dev == ours.st_dev) return file;
  if (ours.st_nlink == 0) return {};
  std::error_code failed;
  auto now = std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", descriptor), failed);
  // One of several names may be the one that was opened and is gone.
  return failed || !std::filesystem::exists(now, failed) ? std::filesystem::path() : now;
}

}  // namespace telekerf
