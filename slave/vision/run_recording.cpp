// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/run_recording.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/recording/run_tables.h"
#include "common/runtime/clock.h"

namespace telekerf::vision_process {
namespace {

std::vector<std::string> names_of(const TelemetryMessage& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values.values) names.push_back(name);
  return names;
}

}  // namespace

RunRecording::RunRecording(const RecordFlags& flags, RunIdentity identity, const TelemetryMessage& values,
                           StatusReporter& status)
    : names_(names_of(values)),
      recording_(flags, std::move(identity),
                 {{schema_of("operator", operator_columns()), 100.0}, {telemetry_schema(names_), 20.0}}, status) {}

void RunRecording::published(const ContourMessage& contour) { recording_.contours(std::array{contour}); }

void RunRecording::heard(const EventMessage& event, Tick tick) {
  recording_.push(kOperator, operator_columns(),
                  OperatorRow{.tick = static_cast<std::uint64_t>(tick),
                              .t_s = 1e-9 * static_cast<double>(monotonic_ns()),
                              .kind = static_cast<std::uint32_t>(event.kind),
                              .asker = event.epoch,
                              .value = event.value});
}

void RunRecording::values(const TelemetryMessage& values) {
  RowRing* const ring = recording_.ring(kTelemetry);
  if (ring == nullptr) return;
  row_.assign({static_cast<double>(values.tick), 1e-9 * static_cast<double>(monotonic_ns())});
  for (const std::string& name : names_) {
    const auto found = std::find_if(values.values.begin(), values.values.end(),
                                    [&](const auto& value) { return value.first == name; });
    row_.push_back(found == values.values.end() ? 0.0 : found->second);
  }
  ring->push(row_);
}

}  // namespace telekerf::vision_process
