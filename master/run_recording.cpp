// SPDX-License-Identifier: Apache-2.0
#include "master/run_recording.h"

#include <utility>

#include "common/recording/run_reader.h"
#include "common/runtime/clock.h"

namespace telekerf::master {
std::vector<Recording::Part> RunRecording::parts(double control_hz) {
  return {{schema_of("master", master_columns(), true), control_hz},
          {schema_of("blocks", block_columns()), 2500.0},
          {schema_of("operator", operator_columns()), 100.0},
          {schema_of("in_force", in_force_columns()), 10.0},
          {telemetry_schema(std::vector<std::string>(kMasterValueNames.begin(), kMasterValueNames.end())), 100.0}};
}

RunIdentity RunRecording::with_station(RunIdentity identity) const {
  RunRecord known;
  station_.report(known);
  known.master_figures.erase("dropped_rows");
  identity.figures.merge(known.master_figures);
  identity.words.merge(known.words);
  identity.drive = known.master_drive;
  return identity;
}

RunRecording::RunRecording(const RecordFlags& flags, RunIdentity identity, Station& station,
                           StatusReporter& status)
    : station_(station),
      text_(flags.named()),
      row_(kMasterValueNames.size() + 2),
      recording_(flags, with_station(std::move(identity)), parts(1.0 / station.control_period_s()), status) {
  station.record_to(recording_.ring(kRows));
}

void RunRecording::step(std::int64_t now_ns, std::span<const Received<StateBlock>> states,
                        std::span<const EventMessage> events, const StationOutputs& out) noexcept {
  const Tick tick = station_.node().tick();
  const double now_s = 1e-9 * static_cast<double>(now_ns);
  for (const Received<StateBlock>& state : states)
    recording_.push(kBlocks, block_columns(), row_of(state.value, tick, state.received_ns, true));
  if (out.command) recording_.push(kBlocks, block_columns(), row_of(*out.command, tick, now_ns, false));
  for (const EventMessage& event : events) {
    if (!OperatorRequests::concerns(event)) continue;
    recording_.push(kOperator, operator_columns(),
                    {tick, now_s, false, static_cast<std::uint32_t>(event.kind), event.epoch, event.value});
  }
  if (out.stop != stop_) {
    recording_.push(kOperator, operator_columns(), {tick, now_s, true, 0, 0, static_cast<double>(out.stop)});
    if (out.stop != 0) recording_.fault("emergency stop");
    stop_ = out.stop;
  }
  for (const auto began = station_.in_force(); contours_ < began.size(); ++contours_)
    recording_.push(kInForce, in_force_columns(), {began[contours_].tick, now_s, began[contours_].id});
  if (station_.machine().failed()) recording_.fault("the master's robot has failed");
}

void RunRecording::values(const TelemetryMessage& values) {
  RowRing* const ring = recording_.ring(kTelemetry);
  if (ring == nullptr) return;
  row_.assign({static_cast<double>(values.tick), 1e-9 * static_cast<double>(monotonic_ns())});
  for (const auto& [name, value] : values.values) row_.push_back(value);
  ring->push(row_);
}

bool RunRecording::close(RunRecord& record) {
  record.master_figures["dropped_rows"] = static_cast<double>(recording_.dropped());
  if (!recording_.close({.figures = record.master_figures, .words = record.words}) || !text_) return false;
  if (const auto rows = RunReader(recording_.file(), RunReader::Check::kHead).data("master"))
    record.master = rows_of(*rows, master_columns());
  return true;
}

}  // namespace telekerf::master
