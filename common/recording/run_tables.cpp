// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_tables.h"

#include <utility>

namespace telekerf {
namespace {

template <auto Member>
constexpr Column<BlockRow> block(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, BlockRow>(name, unit, sentence);
}
template <auto Member>
constexpr Column<OperatorRow> asked(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, OperatorRow>(name, unit, sentence);
}
template <auto Member>
constexpr Column<InForceRow> in_force(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, InForceRow>(name, unit, sentence);
}
template <auto Member>
constexpr Column<GuardRow> guard(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, GuardRow>(name, unit, sentence);
}

// clang-format off
constexpr Column<BlockRow> kBlocks[] = {
    block<&BlockRow::tick>("tick", "", "control step of this process at which it was sent or taken"),
    block<&BlockRow::t_s>("t_s", "s", "sent, or arrived; monotonic clock of this computer"),
    block<&BlockRow::received>("received", "", "1: received, 0: sent"),
    block<&BlockRow::sequence>("sequence", "", "number of the block"),
    block<&BlockRow::epoch>("epoch", "", "of the process that has sent it"),
    block<&BlockRow::first_tick>("first_tick", "", "its sender's tick of its first sample"),
    block<&BlockRow::sent_s>("sent_s", "s", "handed to the bus, by its sender's clock"),
    block<&BlockRow::contour_id>("contour_id", "", "of the contour in force at its sender"),
    block<&BlockRow::beta>("beta", "", "slave motion = beta x master motion"),
    block<&BlockRow::engaged>("engaged", "", "of a command: the slave shall follow; of a state: it does"),
    block<&BlockRow::stop>("stop", "", "number of the emergency stop that its sender obeys; 0: none"),
    block<&BlockRow::echo_sequence>("echo_sequence", "", "newest block of the other direction that its sender had"),
    block<&BlockRow::applied_tick>("applied_tick", "", "of a state: newest master tick applied; negative: of a command"),
    block<&BlockRow::interlock>("interlock", "", "of a state: why the laser is off; negative: of a command"),
    block<&BlockRow::guards>("guards", "", "of a state: bit n: guard n forbids the beam"),
    block<&BlockRow::command_age_s>("command_age_s", "s", "of a state: age of the command whose turn it was; negative: none"),
    block<&BlockRow::payload_bytes>("payload_bytes", "", "coded samples"),
};

constexpr Column<OperatorRow> kOperator[] = {
    asked<&OperatorRow::tick>("tick", "", "control step at which it was heard"),
    asked<&OperatorRow::t_s>("t_s", "s", "monotonic clock of this computer"),
    asked<&OperatorRow::stop>("stop", "", "1: another emergency stop, 0: an event"),
    asked<&OperatorRow::kind>("kind", "", "of an event: number of the contract's EventKind"),
    asked<&OperatorRow::asker>("asker", "", "epoch of who has asked"),
    asked<&OperatorRow::value>("value", "", "of the event; of a stop its number, 0: none any more"),
};

constexpr Column<InForceRow> kInForce[] = {
    in_force<&InForceRow::tick>("tick", "", "control step since which the contour is in force"),
    in_force<&InForceRow::t_s>("t_s", "s", "monotonic clock of this computer"),
    in_force<&InForceRow::contour_id>("contour_id", "", "as in contours/list"),
};

constexpr Column<GuardRow> kGuards[] = {
    guard<&GuardRow::tick>("tick", "", "control step at which something of it changed"),
    guard<&GuardRow::t_s>("t_s", "s", "monotonic clock of this computer"),
    guard<&GuardRow::forbidden>("forbidden", "", "bit n: guard n forbids the beam"),
    guard<&GuardRow::mode>("mode", "", "of the slave, number of the contract's SlaveMode"),
    guard<&GuardRow::reason>("reason", "", "why it does not follow, number of the contract's HoldReason"),
    guard<&GuardRow::stop>("stop", "", "number of the emergency stop that is obeyed; 0: none"),
};
// clang-format on

/// Of a value's name, which says it: "tool_x_m_per_s".
std::string unit_of_name(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_m_per_s2", "m/s^2"}, {"_m_per_s", "m/s"}, {"_m", "m"}, {"_n", "N"}, {"_s", "s"}};
  for (const auto& [suffix, unit] : kUnits)
    if (name.ends_with(suffix)) return std::string(unit);
  return {};
}

}  // namespace

SeriesSchema telemetry_schema(std::span<const std::string> names) {
  SeriesSchema schema{"telemetry", {}};
  schema.columns.push_back({"tick", "", "", "control step of the process", ColumnKind::kCount});
  schema.columns.push_back({"t_s", "s", "", "monotonic clock of this computer"});
  for (const std::string& name : names) schema.columns.push_back({name, unit_of_name(name), "", ""});
  return schema;
}

std::span<const Column<BlockRow>> block_columns() { return kBlocks; }
std::span<const Column<GuardRow>> guard_columns() { return kGuards; }
std::span<const Column<OperatorRow>> operator_columns() { return kOperator; }
std::span<const Column<InForceRow>> in_force_columns() { return kInForce; }

}  // namespace telekerf
