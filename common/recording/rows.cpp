// SPDX-License-Identifier: Apache-2.0
#include "common/recording/rows.h"

namespace telekerf {
namespace {

constexpr const char* kMasterFrame = "master's workpiece";
constexpr const char* kFrame = "workpiece";

template <auto Member>
constexpr Column<MasterRow> master(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, MasterRow>(name, unit, sentence);
}
template <auto Member>
constexpr Column<SlaveRow> slave(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, SlaveRow>(name, unit, sentence);
}

// clang-format off
constexpr Column<MasterRow> kMaster[] = {
    master<&MasterRow::tick>("tick", "", "control step of the master"),
    master<&MasterRow::t_s>("t_s", "s", "monotonic clock of the master's computer"),
    component<&MasterRow::tool_m, 0, MasterRow>("tool_x_m", "m", kMasterFrame, "true tool, or the measured one where nobody knows it"),
    component<&MasterRow::tool_m, 1, MasterRow>("tool_y_m", "m", kMasterFrame, ""),
    component<&MasterRow::tool_m, 2, MasterRow>("tool_z_m", "m", kMasterFrame, ""),
    component<&MasterRow::hand_n, 0, MasterRow>("hand_x_n", "N", kMasterFrame, "force of the hand on the tool; of a real hand what is estimated"),
    component<&MasterRow::hand_n, 1, MasterRow>("hand_y_n", "N", kMasterFrame, ""),
    component<&MasterRow::hand_n, 2, MasterRow>("hand_z_n", "N", kMasterFrame, ""),
    master<&MasterRow::constraint_n>("constraint_n", "N", "force by which the constraint answers, across the curve"),
    master<&MasterRow::guided>("guided", "", "1: on the constraint, the hand moves it"),
    master<&MasterRow::engaged>("engaged", "", "1: the slave follows"),
    master<&MasterRow::button>("button", "", "1: the operator wants the laser"),
    component<&MasterRow::predicted_m, 0, MasterRow>("predicted_x_m", "m", kFrame, "slave's tool when it applies this tick, as predicted"),
    component<&MasterRow::predicted_m, 1, MasterRow>("predicted_y_m", "m", kFrame, ""),
    component<&MasterRow::predicted_m, 2, MasterRow>("predicted_z_m", "m", kFrame, ""),
    master<&MasterRow::joined>("joined", "", "1: engaged, and nothing is left of the approach of the slave to the master"),
    master<&MasterRow::force_tick>("force_tick", "", "slave tick of the force that follows; negative: none is known"),
    component<&MasterRow::slave_force_n, 0, MasterRow>("slave_force_x_n", "N", kFrame, "on the slave's tool, as fed back"),
    component<&MasterRow::slave_force_n, 1, MasterRow>("slave_force_y_n", "N", kFrame, ""),
    component<&MasterRow::slave_force_n, 2, MasterRow>("slave_force_z_n", "N", kFrame, ""),
    master<&MasterRow::beta>("beta", "", "slave motion = beta x master motion"),
};

constexpr Column<SlaveRow> kSlave[] = {
    slave<&SlaveRow::tick>("tick", "", "control step of the slave"),
    slave<&SlaveRow::t_s>("t_s", "s", "monotonic clock of the slave's computer"),
    slave<&SlaveRow::applied>(
        "applied_tick", "",
        "master tick that is applied, between two of them a fraction; negative: none, the slave holds"),
    component<&SlaveRow::ref_m, 0, SlaveRow>("ref_x_m", "m", kFrame, "reference of the control loop"),
    component<&SlaveRow::ref_m, 1, SlaveRow>("ref_y_m", "m", kFrame, ""),
    component<&SlaveRow::ref_m, 2, SlaveRow>("ref_z_m", "m", kFrame, ""),
    component<&SlaveRow::tool_m, 0, SlaveRow>("tool_x_m", "m", kFrame, "true tool, or the measured one where nobody knows it"),
    component<&SlaveRow::tool_m, 1, SlaveRow>("tool_y_m", "m", kFrame, ""),
    component<&SlaveRow::tool_m, 2, SlaveRow>("tool_z_m", "m", kFrame, ""),
    slave<&SlaveRow::laser_w>("laser_w", "W", "power that the laser was told"),
    slave<&SlaveRow::interlock>("interlock", "", "why the laser is off, a number of the contract's Interlock; 0: it may burn"),
    slave<&SlaveRow::settled>("settled", "", "1: following, and no offset of an approach is left"),
    component<&SlaveRow::force_n, 0, SlaveRow>("force_x_n", "N", kFrame, "estimated, of the world on the tool"),
    component<&SlaveRow::force_n, 1, SlaveRow>("force_y_n", "N", kFrame, ""),
    component<&SlaveRow::force_n, 2, SlaveRow>("force_z_n", "N", kFrame, ""),
};

constexpr Column<Vec2> kContour[] = {
    {"x_m", "m", kFrame, "the contour as extracted, true size", [](const Vec2& p) { return p.x(); }, [](Vec2& p, double x) { p.x() = x; }},
    {"y_m", "m", kFrame, "", [](const Vec2& p) { return p.y(); }, [](Vec2& p, double y) { p.y() = y; }},
};
// clang-format on

}  // namespace

std::span<const Column<MasterRow>> master_columns() { return kMaster; }
std::span<const Column<SlaveRow>> slave_columns() { return kSlave; }
std::span<const Column<Vec2>> contour_columns() { return kContour; }

}  // namespace telekerf
