// SPDX-License-Identifier: Apache-2.0
// What one process writes of one run, in an HDF5 file of its own: who it was, tables of numbers, what it said
// and which contours it had. docs/reference/recording.md describes the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/recording/h5.h"
#include "common/recording/run_record.h"
#include "common/recording/series.h"

namespace telekerf {

/// Known when a run begins.
struct RunIdentity {
  std::string role = {};     ///< "master", "slave"
  std::string program = {};  ///< "telekerf-master"
  std::string cell = {};
  std::uint32_t epoch = 0;
  bool virtual_time = false;
  std::string created_utc = {};     ///< ISO 8601
  std::int64_t utc_at_zero_ns = 0;  ///< of the monotonic clock's zero, so that stamps can be dated
  std::string settings = {};        ///< as --config reads them
  std::string network = {};         ///< the profile's file; empty: the real network
  Metadata words = {};              ///< as far as they are known
  Metrics figures = {};             ///< likewise
  DriveRecord drive = {};
};
/// Created now, on this computer.
void date_now(RunIdentity& identity);

/// Something that happened, or was said.
struct RunEvent {
  double t_s = 0.0;  ///< monotonic clock of the process' computer
  std::int64_t tick = -1;
  std::string kind = {};  ///< "said", "fault", "operator", "recorder"
  double value = 0.0;
  std::string text = {};
};

/// A contour that was in force.
struct RunContour {
  std::uint32_t id = 0;
  bool closed = true;
  std::int64_t from_tick = -1;  ///< the first at which it was in force; negative: it was prepared only
  double t_s = 0.0;
  double metres_per_pixel = 0.0;
  double deviation_m = 0.0;
  std::string mode = {};
  std::string source = {};
  std::vector<Vec2> points_m = {};
};

/// A contour as it was published (ContourMessage, which a recording need not know), prepared only.
template <typename Contour>
RunContour recorded(const Contour& contour) {
  return {.id = contour.id,
          .closed = contour.closed,
          .metres_per_pixel = contour.metres_per_pixel,
          .deviation_m = contour.deviation_m,
          .mode = contour.mode,
          .source = contour.source,
          .points_m = contour.points_m};
}

/// How a file came to its end.
enum class RunState { kRecording, kClosed, kRecovered };
const char* word_of(RunState state);

namespace run_file {

inline constexpr const char* kFormat = "telekerf-run";
/// Root attribute of an unfinished file: the names of its series, a space between them.
inline constexpr const char* kSeries = "series";
inline constexpr std::uint64_t kVersion = 2;
inline constexpr std::uint64_t kVersionWithoutSum = 1;  ///< is read as well

/// The rows of `events` and of `contours/list` as they stand in memory and in the file.
struct EventCell {
  double t_s;
  std::int64_t tick;
  double value;
  char kind[16];
  char text[232];
};
struct ContourCell {
  std::uint32_t id;
  std::uint32_t closed;
  std::int64_t from_tick;
  std::uint64_t first;
  std::uint64_t count;
  double t_s;
  double metres_per_pixel;
  double deviation_m;
  char mode[16];
  char source[232];
};
h5::Id event_type();
h5::Id contour_type();
EventCell cell_of(const RunEvent& event);
RunEvent event_of(const EventCell& cell);
ContourCell cell_of(const RunContour& contour, std::uint64_t first);
RunContour contour_of(const ContourCell& cell);

/// The attributes of a file's root, and the groups `words` and `figures`.
void write_identity(hid_t file, const RunIdentity& identity, RunState state);
RunIdentity read_identity(hid_t file);
/// The attributes of a series' group.
void write_schema(hid_t group, const SeriesSchema& schema);
SeriesSchema read_schema(hid_t group, const std::string& name);

}  // namespace run_file

}  // namespace telekerf
