// SPDX-License-Identifier: Apache-2.0
// What a run leaves behind: the rows of each robot, and the figures that only the process itself knows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/recording/recorder.h"
#include "common/recording/rows.h"
#include "common/runtime/loop.h"

namespace telekerf {

/// Named figures of a process ("rtt_p50_ms" -> 100.2), kept in order of their names.
using Metrics = std::map<std::string, double>;
/// What the control loop measured of itself, as figures.
void add_figures(const LoopStatistics& loop, Metrics& figures);

using Metadata = std::map<std::string, std::string>;

/// What moved a robot, and with it what its rows can tell.
struct DriveRecord {
  std::string name = "simulated";  ///< as the user chose it
  bool true_tool = true;           ///< false: nobody knows it, the rows hold the measured one
};
/// As results say it: `name`, and `tool`: "true" or "measured".
Metadata words_of(const DriveRecord& drive);

/// A contour that was in force before another one took its place.
struct EarlierContour {
  std::uint64_t until_tick = 0;  ///< of the master: the first at which the next one was in force
  bool closed = true;
  std::vector<Vec2> points_m;
};

struct RunRecord {
  std::vector<Vec2> contour_m;  ///< as extracted, true size
  bool contour_closed = true;
  std::vector<EarlierContour> earlier;  ///< in order; the one above was the last
  std::vector<MasterRow> master;
  std::vector<SlaveRow> slave;
  Metrics master_figures, slave_figures;
  DriveRecord master_drive, slave_drive;
  Metadata words;  ///< netem, law, codec, image ...
};

/// Refuses a folder that holds the record of another run of `site` ("master", "slave"), and one that cannot
/// be written to. Nothing is made. `option`: that names it.
void refuse_record_folder(const std::string& option, const std::filesystem::path& folder,
                          const std::string& site);

/// CSV and JSON files in `folder` (created if need be); each site writes its own part. Throws StartupError.
void write_contour(const std::filesystem::path& folder, const RunRecord& record);
void write_master(const std::filesystem::path& folder, const RunRecord& record);
void write_slave(const std::filesystem::path& folder, const RunRecord& record);
/// The same again, with the contour in the master's part; they throw StartupError that names the file and
/// line.
void read_master(const std::filesystem::path& folder, RunRecord& record);
void read_slave(const std::filesystem::path& folder, RunRecord& record);

}  // namespace telekerf
