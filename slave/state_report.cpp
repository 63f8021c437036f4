// SPDX-License-Identifier: Apache-2.0
#include "slave/state_report.h"

#include "common/protocol/wire_precision.h"

namespace telekerf::slave {
namespace {

streaming::PacketizerSettings packets_of(const StateReportSettings& settings,
                                         const codec::StreamSettings& codec, std::uint32_t epoch) {
  return {
      .codec = codec,
      .ticks_per_sample = settings.ticks_per_sample,
      .sample_period_ns = static_cast<std::uint32_t>(settings.control_period_ns * settings.ticks_per_sample),
      .epoch = epoch};
}

}  // namespace

StateReport::StateReport(const StateReportSettings& settings, std::uint32_t epoch)
    : ticks_per_sample_(static_cast<Tick>(settings.ticks_per_sample)),
      positions_(packets_of(settings, settings.positions, epoch)),
      forces_(packets_of(settings, settings.forces, epoch)) {}

void StateReport::change(const codec::StreamSettings& positions, codec::StreamSettings forces) {
  forces.block = positions.block;
  const codec::StreamSettings next = forces.validated();
  positions_.change(positions);
  forces_.change(next);
}

std::optional<StateBlock> StateReport::step(std::int64_t now_ns, Tick tick, const ReportSample& sample,
                                            const streaming::CommandReceiver& commands,
                                            const streaming::Acknowledgement& acknowledgement) noexcept {
  std::optional<StateBlock> out;
  if (tick % ticks_per_sample_ != 0) return out;
  if (positions_.at_beginning()) {
    const auto index = static_cast<std::int64_t>(tick / ticks_per_sample_);
    positions_.begin(index, to_wire_precision(Anchor{sample.tool_m, sample.velocity_m_per_s}));
    forces_.begin(index, {});
  }
  forces_.add(sample.force_n, false);
  if (!positions_.add(sample.tool_m, sample.laser_on)) return out;

  StateBlock& block = out.emplace();
  block.laser_on = sample.laser_on;
  block.interlock = sample.interlock;
  block.contour_id = sample.contour_id;
  block.mode = sample.mode;
  block.reason = sample.reason;
  block.engage = sample.engage_spent;
  block.stop = sample.stop;
  block.stop_tick = sample.stop_tick;
  block.guards = sample.guards;
  block.command_age_s = sample.command_age_s;
  commands.describe(acknowledgement, block);
  if (!positions_.pack(now_ns, block)) return std::nullopt;
  (void)forces_.encode(block.force);  // without the forces the positions are still worth sending
  ++counters_.states;
  counters_.position_bytes += block.payload.size;
  counters_.force_bytes += block.force.size;
  return out;
}

}  // namespace telekerf::slave
