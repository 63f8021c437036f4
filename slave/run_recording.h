// SPDX-License-Identifier: Apache-2.0
// What the slave records of a run: a row a tick, blocks' heads, what forbids the beam, contours.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "common/recording/process_recording.h"
#include "common/recording/run_tables.h"
#include "slave/station.h"

namespace telekerf::slave {

class RunRecording {
 public:
  /// `identity`: with what the station does not know (cell, network, settings). The station's rows go into
  /// the record from now on. Throws StartupError.
  RunRecording(const RecordFlags& flags, RunIdentity identity, Station& station, StatusReporter& status);

  /// The loop, after each step; wait-free.
  void step(std::int64_t now_ns, const Corridor* corridor, std::span<const Received<CommandBlock>> commands,
            const SlaveOutputs& out) noexcept;
  /// Beside the loop.
  void contours(std::span<const ContourMessage> adopted) { recording_.contours(adopted); }

  /// As the master's.
  bool close(RunRecord& record);
  /// Where the file lies, wherever somebody has moved it.
  std::filesystem::path folder() const { return recording_.file().parent_path(); }
  /// As ProcessRecording's.
  void refuse_unfinished() const { recording_.refuse_unfinished(); }

 private:
  enum Part : std::size_t { kRows, kBlocks, kGuards, kInForce };
  static std::vector<Recording::Part> parts(double control_hz);
  RunIdentity with_station(RunIdentity identity) const;

  const Station& station_;
  bool text_;
  GuardRow guards_;
  bool any_ = false;
  std::uint32_t contour_ = 0;
  ProcessRecording recording_;
};

}  // namespace telekerf::slave
