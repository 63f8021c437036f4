// SPDX-License-Identifier: Apache-2.0
// Records a run while it goes on. The control loop stores rows in a ring; a thread beside it writes them out
// twenty times a second, so that a killed process loses less than a tenth of one, and what it had not written
// out yet lies in memory that outlives it.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/recording/live_file.h"
#include "common/recording/row_ring.h"
#include "common/recording/run_closing.h"

namespace telekerf {

class Recording {
 public:
  static constexpr std::chrono::milliseconds kPeriod{50};
  /// At full detail, on every fault (`flight-ROLE-N.h5` beside the file).
  static constexpr double kFlight_s = 10.0;

  struct Part {
    SeriesSchema schema;
    double rows_per_s = 0.0;  ///< at most
  };
  using Say = std::function<void(const std::string&)>;
  /// Bytes free where a file lies; none: nobody knows.
  using FreeSpace = std::function<std::optional<std::uint64_t>(const std::filesystem::path&)>;
  static std::optional<std::uint64_t> free_space(const std::filesystem::path& file);

  /// Makes the file and everything in it; `say` hears, in the recorder's thread, what people should know.
  /// Throws StartupError.
  Recording(std::filesystem::path file, const RunIdentity& identity, const std::vector<Part>& parts, Say say,
            FreeSpace space = free_space);
  /// Unless it was closed, the file stays as that of a killed process.
  ~Recording();

  /// Where the part's rows go; one producer each.
  RowRing& ring(std::size_t part) noexcept { return *parts_[part].ring; }
  /// Any thread but the control loop's.
  void add(RunEvent event);
  void add(RunContour contour);
  /// The control loop: wait-free. A literal.
  void fault(const char* what) noexcept { fault_.store(what, std::memory_order_release); }

  /// Rows that never came into the file.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  /// Rows of the first part that are safe whatever happens to the process.
  std::uint64_t acknowledged() const noexcept { return acknowledged_.load(std::memory_order_acquire); }
  const std::filesystem::path& file() const noexcept { return file_; }

  /// After the loop: writes out the rest and finishes the file. None, and said: it could not be finished.
  std::optional<RunKept> close(RunEnd end);

 private:
  struct Running {
    SeriesSchema schema;
    std::unique_ptr<RowRing> ring;
    std::uint64_t taken = 0;
    std::uint64_t dropped = 0;
    std::vector<double> numbers;
  };
  void run(const std::stop_token& stop);
  void write_out();
  void take_rows(bool write);
  void look_at_disk();
  void look_at_file();
  void look_at_drops();
  void look_at_fault();
  void write_flight(const RunEvent& event);

  std::filesystem::path file_;
  RunIdentity identity_;
  Say say_;
  std::vector<Running> parts_;
  std::unique_ptr<LiveFile> live_;
  std::mutex mutex_;
  std::vector<RunEvent> events_;      ///< to be written
  std::vector<RunContour> contours_;  ///< likewise
  std::atomic<const char*> fault_{nullptr};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> acknowledged_{0};
  FreeSpace space_;
  bool disk_full_ = false;
  bool gone_ = false;  ///< somebody has removed the file
  std::uint64_t dropped_said_ = 0;
  std::chrono::steady_clock::time_point looked_;
  int flights_ = 0;
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
