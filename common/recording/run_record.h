// SPDX-License-Identifier: Apache-2.0
// What a run leaves behind: one row a tick of each robot, and the figures that only the process itself knows.
// Metres; the master's rows in the master's workpiece frame, the slave's in the workpiece frame.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/loop.h"

namespace telekerf {

using Triple = std::array<double, 3>;

struct MasterRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  Triple tool_m{};            ///< true tool, or the measured one (DriveRecord)
  Triple hand_n{};            ///< hand force on the tool; of a real hand what is estimated
  double constraint_n = 0.0;  ///< force by which the constraint answers, across the curve
  bool guided = false;        ///< on the constraint, the hand moves it
  bool engaged = false;       ///< the slave follows
  bool button = false;
  Triple predicted_m{};  ///< slave's tool when it applies this tick, as predicted; slave's workpiece frame
  bool joined = false;   ///< engaged, and nothing is left of the approach of the slave to the master
  double beta = 1.0;     ///< slave motion = beta x master motion; may change during a run
  double force_tick = -1.0;  ///< slave tick of the force below; negative: none is known
  Triple slave_force_n{};    ///< on the slave's tool, as fed back; slave's workpiece frame
};

struct SlaveRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  double applied = -1.0;  ///< master tick being applied; negative: none (holding)
  Triple ref_m{};         ///< commanded reference
  Triple tool_m{};        ///< true tool, or the measured one (DriveRecord)
  double laser_w = 0.0;
  int interlock = 0;
  bool settled = false;  ///< following, and no offset of an approach is left
  Triple force_n{};      ///< estimated, of the world on the tool
};

/// Rows kept in memory that is taken before the loop starts; when it is full, further rows are counted only.
template <typename Row>
class Recorder {
 public:
  explicit Recorder(std::size_t capacity) { rows_.reserve(capacity); }
  void push(const Row& row) noexcept {
    if (rows_.size() < rows_.capacity()) {
      rows_.push_back(row);
    } else {
      ++dropped_;
    }
  }
  const std::vector<Row>& rows() const { return rows_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<Row> rows_;
  std::uint64_t dropped_ = 0;
};

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

struct RunRecord {
  std::vector<std::array<double, 2>> contour_m;  ///< as extracted, true size
  bool contour_closed = true;
  std::vector<MasterRow> master;
  std::vector<SlaveRow> slave;
  Metrics master_figures, slave_figures;
  DriveRecord master_drive, slave_drive;
  Metadata words;  ///< netem, law, codec, image ...
};

/// CSV and JSON files in `folder` (created if need be); each site writes its own part. Throws StartupError.
void write_contour(const std::filesystem::path& folder, const RunRecord& record);
void write_master(const std::filesystem::path& folder, const RunRecord& record);
void write_slave(const std::filesystem::path& folder, const RunRecord& record);
/// Everything again; throws StartupError that names the file and line.
RunRecord read_run(const std::filesystem::path& folder);

}  // namespace telekerf
