// SPDX-License-Identifier: Apache-2.0
// What vision records of a run: contours as they were published, what it was asked for, and its values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/protocol/messages.h"
#include "common/recording/process_recording.h"

namespace telekerf::vision_process {

class RunRecording {
 public:
  /// `values`: as they are at the start; those that come later are not recorded. Throws StartupError.
  RunRecording(const RecordFlags& flags, RunIdentity identity, const TelemetryMessage& values, StatusReporter& status);
  void published(const ContourMessage& contour);
  void heard(const EventMessage& event, Tick tick);
  void values(const TelemetryMessage& values);
  void close() { recording_.close({}); }
  /// As ProcessRecording's.
  void refuse_unfinished() const { recording_.refuse_unfinished(); }

 private:
  enum Part : std::size_t { kOperator, kTelemetry };
  std::vector<std::string> names_;  ///< of the values
  std::vector<double> row_;
  ProcessRecording recording_;
};

}  // namespace telekerf::vision_process
