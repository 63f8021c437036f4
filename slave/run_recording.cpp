// SPDX-License-Identifier: Apache-2.0
#include "slave/run_recording.h"

#include <utility>

#include "common/recording/run_reader.h"

namespace telekerf::slave {

std::vector<Recording::Part> RunRecording::parts(double control_hz) {
  return {{schema_of("slave", slave_columns(), true), control_hz},
          {schema_of("blocks", block_columns()), 2500.0},
          {schema_of("guards", guard_columns()), control_hz},
          {schema_of("in_force", in_force_columns()), 10.0}};
}

RunIdentity RunRecording::with_station(RunIdentity identity) const {
  RunRecord known;
  station_.report(known);
  known.slave_figures.erase("dropped_rows");
  identity.figures.merge(known.slave_figures);
  identity.drive = known.slave_drive;
  return identity;
}

RunRecording::RunRecording(const RecordFlags& flags, RunIdentity identity, Station& station,
                           StatusReporter& status)
    : station_(station),
      text_(flags.named()),
      recording_(flags, with_station(std::move(identity)), parts(1.0 / station.control_period_s()), status) {
  station.record_to(recording_.ring(kRows));
}

void RunRecording::step(std::int64_t now_ns, const Corridor* corridor,
                        std::span<const Received<CommandBlock>> commands, const SlaveOutputs& out) noexcept {
  const Tick tick = station_.tick();
  const double now_s = 1e-9 * static_cast<double>(now_ns);
  for (const Received<CommandBlock>& command : commands)
    recording_.push(kBlocks, block_columns(), row_of(command.value, tick, command.received_ns, true));
  if (out.state) recording_.push(kBlocks, block_columns(), row_of(*out.state, tick, now_ns, false));
  const GuardRow now{tick,
                     now_s,
                     out.forbidden,
                     static_cast<std::uint32_t>(out.mode),
                     static_cast<std::uint32_t>(out.reason),
                     out.stop};
  if (out.stop != guards_.stop && out.stop != 0) recording_.fault("emergency stop");
  if (!any_ || now.forbidden != guards_.forbidden || now.mode != guards_.mode ||
      now.reason != guards_.reason || now.stop != guards_.stop)
    recording_.push(kGuards, guard_columns(), now);
  guards_ = now;
  any_ = true;
  if (corridor != nullptr && corridor->contour_id != contour_) {
    contour_ = corridor->contour_id;
    recording_.push(kInForce, in_force_columns(), {tick, now_s, contour_});
  }
  if (station_.machine().failed()) recording_.fault("the slave's robot has failed");
  if (station_.beam().failed()) recording_.fault("the laser has failed");
}

bool RunRecording::close(RunRecord& record) {
  record.slave_figures["dropped_rows"] = static_cast<double>(recording_.dropped());
  if (!recording_.close({.figures = record.slave_figures}) || !text_) return false;
  if (const auto rows = RunReader(recording_.file(), RunReader::Check::kHead).data("slave"))
    record.slave = rows_of(*rows, slave_columns());
  return true;
}

}  // namespace telekerf::slave
