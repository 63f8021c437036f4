// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/run_recording.h"

#include <utility>

namespace telekerf::machining {
namespace {

template <auto Member>
constexpr Column<MachineRow> of_machine(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, MachineRow>(name, unit, sentence);
}
template <auto Member, int Axis>
constexpr Column<MachineRow> of_tool(std::string_view name, std::string_view sentence) {
  return component<Member, Axis, MachineRow>(name, "m", "workpiece", sentence);
}

// clang-format off
constexpr Column<MachineRow> kColumns[] = {
    of_machine<&MachineRow::tick>("tick", "", "control step"),
    of_machine<&MachineRow::t_s>("t_s", "s", "monotonic clock of this computer"),
    of_machine<&MachineRow::job_tick>("job_tick", "", "of the planned motion"),
    of_machine<&MachineRow::phase>("phase", "", "0 approaching, 1 framing, 2 travelling, 3 cutting, 4 returning"),
    of_tool<&MachineRow::reference_m, 0>("ref_x_m", "planned"),
    of_tool<&MachineRow::reference_m, 1>("ref_y_m", "planned"),
    of_tool<&MachineRow::reference_m, 2>("ref_z_m", "planned"),
    of_tool<&MachineRow::tool_m, 0>("tool_x_m", "true, or measured where nobody knows it"),
    of_tool<&MachineRow::tool_m, 1>("tool_y_m", "true, or measured where nobody knows it"),
    of_tool<&MachineRow::tool_m, 2>("tool_z_m", "true, or measured where nobody knows it"),
    of_machine<&MachineRow::laser_w>("laser_w", "W", "emitted"),
    of_machine<&MachineRow::interlock>("interlock", "", "why the laser is off, number of the contract's Interlock"),
    of_machine<&MachineRow::forbidden>("forbidden", "", "bit n: guard n forbids the beam"),
};
// clang-format on

}  // namespace

std::span<const Column<MachineRow>> machine_columns() { return kColumns; }

RunRecording::RunRecording(const RecordFlags& flags, RunIdentity identity, double control_hz,
                           StatusReporter& status)
    : recording_(flags, std::move(identity), {{schema_of("machine", machine_columns(), true), control_hz}}, status) {}

void RunRecording::step(std::int64_t now_ns, const JobExecutorOutputs& out, const Vec3& tool_m, double laser_w,
                        bool stop) noexcept {
  recording_.push(0, machine_columns(),
                  MachineRow{tick_++, 1e-9 * static_cast<double>(now_ns), out.tick,
                             static_cast<std::uint32_t>(out.phase), out.reference_m, tool_m, laser_w,
                             static_cast<std::uint32_t>(out.interlock), out.forbidden});
  if (stop) recording_.fault("stopped");
}

}  // namespace telekerf::machining
