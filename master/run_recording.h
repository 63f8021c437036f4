// SPDX-License-Identifier: Apache-2.0
// What the master records of a run: a row a tick, blocks' heads, the operator, contours, telemetry.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/recording/process_recording.h"
#include "common/recording/run_tables.h"
#include "master/station.h"
#include "master/telemetry.h"

namespace telekerf::master {

class RunRecording {
 public:
  /// `identity`: with what the station does not know (cell, network, settings). The station's rows go into
  /// the record from now on. Throws StartupError.
  RunRecording(const RecordFlags& flags, RunIdentity identity, Station& station, StatusReporter& status);

  /// The loop, after each step; wait-free.
  void step(std::int64_t now_ns, std::span<const Received<StateBlock>> states,
            std::span<const EventMessage> events, const StationOutputs& out) noexcept;
  /// Beside the loop.
  void values(const TelemetryMessage& values);
  void contours(std::span<const ContourMessage> adopted) { recording_.contours(adopted); }

  /// After the loop, with the figures that `record` holds. Where the user has named the folder, `record` gets
  /// the rows as well, and true is returned: text is wanted too.
  bool close(RunRecord& record);
  /// Where the file lies, wherever somebody has moved it.
  std::filesystem::path folder() const { return recording_.file().parent_path(); }
  /// As ProcessRecording's.
  void refuse_unfinished() const { recording_.refuse_unfinished(); }

 private:
  enum Part : std::size_t { kRows, kBlocks, kOperator, kInForce, kTelemetry };
  static std::vector<Recording::Part> parts(double control_hz);
  RunIdentity with_station(RunIdentity identity) const;

  const Station& station_;
  bool text_;
  std::uint32_t stop_ = 0;
  std::size_t contours_ = 0;
  std::vector<double> row_;
  ProcessRecording recording_;
};

}  // namespace telekerf::master
