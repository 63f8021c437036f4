// SPDX-License-Identifier: Apache-2.0
#include "master/console/console_recording.h"

#include <utility>

#include "common/recording/run_tables.h"
#include "common/runtime/clock.h"

namespace telekerf::master {
namespace {

template <auto Member>
constexpr Column<HandRow> of_hand(std::string_view name, std::string_view unit, std::string_view sentence) {
  return column<Member, HandRow>(name, unit, sentence);
}

// clang-format off
constexpr Column<HandRow> kHandColumns[] = {
    of_hand<&HandRow::tick>("tick", "", "number of the frame within its session"),
    of_hand<&HandRow::t_s>("t_s", "s", "sent; monotonic clock of this computer"),
    of_hand<&HandRow::session>("session", "", "another number for another hand"),
    of_hand<&HandRow::held>("held", "", "the hand pulls"),
    of_hand<&HandRow::trigger>("trigger", "", "the laser is wanted"),
    of_hand<&HandRow::x_m>("x_m", "m", "where it pulls, on the contour as it was published"),
    of_hand<&HandRow::y_m>("y_m", "m", "where it pulls, on the contour as it was published"),
};
// clang-format on

}  // namespace

std::span<const Column<HandRow>> hand_columns() { return kHandColumns; }

ConsoleRecording::ConsoleRecording(const RecordFlags& flags, RunIdentity identity, StatusReporter& status)
    : recording_(flags, std::move(identity),
                 {{schema_of("hand", hand_columns()), 1000.0}, {schema_of("operator", operator_columns()), 100.0}},
                 status) {}

void ConsoleRecording::sent(const UdpHandFrame& frame) {
  recording_.push(kHand, hand_columns(),
                  HandRow{.tick = frame.sequence,
                          .t_s = 1e-9 * static_cast<double>(frame.sent_ns),
                          .session = frame.session,
                          .held = (frame.flags & UdpHandFrame::kHeld) != 0,
                          .trigger = (frame.flags & UdpHandFrame::kTrigger) != 0,
                          .x_m = frame.x_m,
                          .y_m = frame.y_m});
}

void ConsoleRecording::sent(const EventMessage& event) {
  push(false, static_cast<std::uint32_t>(event.kind), event.epoch, event.value);
}

void ConsoleRecording::sent(const StopMessage& stop) { push(true, 0, stop.epoch, static_cast<double>(stop.number)); }

void ConsoleRecording::push(bool stop, std::uint32_t kind, std::uint32_t asker, double value) {
  recording_.push(kOperator, operator_columns(),
                  OperatorRow{.tick = asked_++,
                              .t_s = 1e-9 * static_cast<double>(monotonic_ns()),
                              .stop = stop,
                              .kind = kind,
                              .asker = asker,
                              .value = value});
}

}  // namespace telekerf::master
