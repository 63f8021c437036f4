// SPDX-License-Identifier: Apache-2.0
// What automatic machining records of a run: a row a control step, and the contours that it works off.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "common/protocol/messages.h"
#include "common/recording/process_recording.h"
#include "slave/machining/job.h"
#include "slave/machining/job_executor.h"

namespace telekerf::machining {

/// Workpiece frame.
struct MachineRow {
  std::uint64_t tick = 0;  ///< of the run; those of the job stand still while the tool is held
  double t_s = 0.0;
  std::uint64_t job_tick = 0;
  std::uint32_t phase = 0;  ///< JobPhase
  Vec3 reference_m = Vec3::Zero();
  Vec3 tool_m = Vec3::Zero();  ///< the truth, or what is measured if nobody knows it
  double laser_w = 0.0;
  std::uint32_t interlock = 0;  ///< the contract's number
  std::uint32_t forbidden = 0;  ///< bit n: guard n forbids the beam
};
std::span<const Column<MachineRow>> machine_columns();

class RunRecording {
 public:
  /// Throws StartupError.
  RunRecording(const RecordFlags& flags, RunIdentity identity, double control_hz, StatusReporter& status);
  void contours(std::span<const ContourMessage> adopted) { recording_.contours(adopted); }
  /// The loop, after each step; wait-free. `tool_m`, `laser_w`: what came of it.
  void step(std::int64_t now_ns, const JobExecutorOutputs& out, const Vec3& tool_m, double laser_w, bool stop) noexcept;
  /// `figures`: of the work.
  void close(Metrics figures) { recording_.close({.figures = std::move(figures)}); }
  /// As ProcessRecording's.
  void refuse_unfinished() const { recording_.refuse_unfinished(); }

 private:
  std::uint64_t tick_ = 0;
  ProcessRecording recording_;
};

}  // namespace telekerf::machining
