// SPDX-License-Identifier: Apache-2.0
#include "common/recording/recording.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/recording/flight.h"
#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

/// How often the disk is looked at, and what is lost to it is said.
constexpr std::chrono::seconds kLook{1};

constexpr double kSpare_s = 2.0;  // that the disk may be slow for
constexpr std::uint64_t kStop_bytes = 64ULL << 20U;
constexpr std::uint64_t kGoOn_bytes = 128ULL << 20U;

/// In memory that outlives the process; where there is none, in the process' own.
std::filesystem::path ring_file(const RunIdentity& identity, const std::string& series) {
  static std::atomic<unsigned> count{0};
  return fmt::format("/dev/shm/telekerf-{}-{}-{}-{}-{}", identity.role, ::getpid(), monotonic_ns(), count++, series);
}

/// While nothing can be written.
constexpr std::size_t kMostWaiting = 10'000;
constexpr std::size_t kMostContoursWaiting = 64;

/// What processes that were killed more than ten minutes ago have left, and nobody has recovered: at most the last
/// tenth of a second is not in their files.
void sweep_rings() {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
    int process = 0;
    char role[32] = {};
    if (std::sscanf(entry.path().filename().c_str(), "telekerf-%31[a-z]-%d-", role, &process) != 2) continue;
    const auto age = std::filesystem::file_time_type::clock::now() - entry.last_write_time(ignored);
    if (age > std::chrono::minutes(10) && !std::filesystem::exists(fmt::format("/proc/{}", process), ignored))
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace

Recording::Recording(std::filesystem::path file, const RunIdentity& identity, const std::vector<Part>& parts,
                     Say say, FreeSpace space)
    : file_(std::move(file)), identity_(identity), say_(std::move(say)), space_(std::move(space)) {
  sweep_rings();
  std::vector<LiveFile::Part> series;
  for (const Part& part : parts) {
    const auto rows = static_cast<std::size_t>(std::ceil((kFlight_s + kSpare_s) * part.rows_per_s)) + 64;
    Running running{part.schema, std::make_unique<RowRing>(part.schema.width(), rows, ring_file(identity, part.schema.name)),
                    0, 0, {}};
    running.numbers.reserve(part.schema.width() * rows);
    series.push_back({part.schema, running.ring->file()});
    parts_.push_back(std::move(running));
  }
  const bool taken = std::filesystem::exists(file_);
  try {
    live_ = std::make_unique<LiveFile>(file_, identity, series);
  } catch (const h5::Failure& failure) {
    if (taken)
      throw environment_error(fmt::format("--record {}: another process records into it; name another folder",
                                          file_.string()));
    throw environment_error(
        fmt::format("--record {}: {}; name a folder with room on a local disk, or on a network's set "
                    "HDF5_USE_FILE_LOCKING=FALSE",
                    file_.string(), failure.what()));
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Recording::~Recording() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::optional<std::uint64_t> Recording::free_space(const std::filesystem::path& file) {
  struct statvfs disk {};
  if (::statvfs(file.c_str(), &disk) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

void Recording::add(RunEvent event) {
  const std::lock_guard lock(mutex_);
  if (events_.size() >= kMostWaiting) return;
  if (event.t_s == 0.0) event.t_s = 1e-9 * static_cast<double>(monotonic_ns());
  events_.push_back(std::move(event));
}

void Recording::add(RunContour contour) {
  const std::lock_guard lock(mutex_);
  if (contours_.size() >= kMostContoursWaiting) return;
  if (contour.t_s == 0.0) contour.t_s = 1e-9 * static_cast<double>(monotonic_ns());
  contours_.push_back(std::move(contour));
}

void Recording::run(const std::stop_token& stop) {
  ::pthread_setname_np(::pthread_self(), "recorder");
  h5::prepare();
  auto next = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    const auto now = std::chrono::steady_clock::now();
    const bool looks = now - looked_ >= kLook;
    if (looks) {
      looked_ = now;
      look_at_file();
      look_at_disk();
    }
    write_out();
    if (looks) look_at_drops();
    look_at_fault();
    next = std::max(next + kPeriod, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

void Recording::take_rows(bool write) {
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    Running& part = parts_[n];
    part.numbers.clear();
    const std::uint64_t first = part.ring->copy(part.taken, part.ring->capacity(), part.numbers);
    std::uint64_t lost = first - part.taken;
    const std::uint64_t rows = part.numbers.size() / part.schema.width();
    part.taken = first + rows;
    if (write && rows > 0) {
      live_->append(n, part.numbers);
    } else {
      lost += rows;
    }
    part.dropped += lost;
    dropped_.fetch_add(lost, std::memory_order_relaxed);
  }
}

void Recording::write_out() {
  std::vector<RunEvent> events;
  std::vector<RunContour> contours;
  const bool writes = live_ != nullptr && !disk_full_;
  if (writes) {  // otherwise they wait until there is room
    const std::lock_guard lock(mutex_);
    events.swap(events_);
    contours.swap(contours_);
  }
  try {
    take_rows(writes);
    if (!writes) return;
    for (const RunContour& contour : contours) live_->append(contour);
    for (const RunEvent& event : events) live_->append(event);
    live_->flush();
    for (std::size_t n = 0; n < parts_.size(); ++n) parts_[n].ring->acknowledge(parts_[n].taken, live_->rows(n));
    if (!parts_.empty()) acknowledged_.store(live_->rows(0), std::memory_order_release);
  } catch (const h5::Failure& failure) {
    live_.reset();
    say_(fmt::format("nothing more is recorded: {}: {}; telekerf-inspect recover {} keeps what is there",
                     file_.string(), failure.what(), file_.string()));
  }
}

void Recording::look_at_disk() {
  const auto left = space_(file_);
  if (!left) return;
  if (!disk_full_ && *left < kStop_bytes) {
    disk_full_ = true;
    say_(fmt::format("the disk is full ({} MB left at {}): nothing is recorded until there is room again", *left >> 20U,
                     file_.parent_path().string()));
  } else if (disk_full_ && *left > kGoOn_bytes) {
    disk_full_ = false;
    say_("there is room on the disk again: the run is recorded");
  }
}

void Recording::look_at_file() {
  if (gone_ || live_ == nullptr) return;
  const std::filesystem::path now = live_->place(file_);
  if (now == file_) return;
  gone_ = now.empty();
  say_(gone_ ? fmt::format("{} has been removed: this run leaves no record; start anew to have one", file_.string())
             : fmt::format("{} has been moved: it goes on as {}", file_.string(), now.string()));
  if (!gone_) file_ = now;
}

void Recording::look_at_drops() {
  const std::uint64_t dropped = this->dropped();
  if (dropped == dropped_said_) return;
  dropped_said_ = dropped;
  say_(fmt::format("{} rows are not in the record", dropped));
  add(RunEvent{0.0, -1, "recorder", static_cast<double>(dropped), "rows that are not in the record, so far"});
}

void Recording::look_at_fault() {
  const char* const what = fault_.exchange(nullptr, std::memory_order_acq_rel);
  if (what == nullptr) return;
  const RunEvent event{1e-9 * static_cast<double>(monotonic_ns()), -1, "fault", 0.0, what};
  add(event);
  write_flight(event);
}

void Recording::write_flight(const RunEvent& event) {
  constexpr int kMostFlights = 20;
  if (flights_ == kMostFlights) return;
  std::vector<SeriesData> last;
  for (const Running& part : parts_) {
    SeriesData data{part.schema, {}};
    const std::uint64_t head = part.ring->head();
    (void)part.ring->copy(head > part.ring->capacity() ? head - part.ring->capacity() : 0, part.ring->capacity(),
                          data.numbers);
    last.push_back(std::move(data));
  }
  const auto place = file_.parent_path() / fmt::format("flight-{}-{}.h5", identity_.role, ++flights_);
  try {
    telekerf::write_flight(place, identity_, last, event);
    say_(fmt::format("the last {:.0f} s are in {} ({})", kFlight_s, place.string(), event.text));
  } catch (const h5::Failure& failure) {
    say_(fmt::format("the last {:.0f} s could not be written to {}: {}", kFlight_s, place.string(), failure.what()));
  }
}

std::optional<RunKept> Recording::close(RunEnd end) {
  thread_.request_stop();
  thread_.join();
  look_at_fault();
  write_out();
  look_at_file();
  for (const Running& part : parts_) end.dropped[part.schema.name] += part.dropped;
  if (live_ == nullptr || gone_) {
    if (!gone_ && dropped() > 0) say_(fmt::format("{} rows are not in {}", dropped(), file_.string()));
    return std::nullopt;
  }
  live_.reset();
  try {
    return finish_run_file(file_, end);
  } catch (const std::exception& failure) {  // it is all there, or in the memory, and can be finished later
    for (const Running& part : parts_) part.ring->keep();
    say_(fmt::format("{} is not finished: {}; telekerf-inspect recover {} finishes it", file_.string(),
                     failure.what(), file_.string()));
    return std::nullopt;
  }
}

}  // namespace telekerf
