// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/verify.h"

#include <algorithm>
#include <iterator>

#include "netem/verify/bottleneck_checks.h"
#include "netem/verify/delay_checks.h"
#include "netem/verify/impairment_checks.h"
#include "netem/verify/loss_checks.h"
#include "netem/verify/trace_checks.h"

namespace telekerf::netem {
namespace {

StageReport verify_recording(const DirectionProfile& nominal, const DirectionProfile& emulated,
                             Direction direction, const Traffic& traffic) {
  const Run measured = run(emulated, direction, traffic);
  Checks checks;
  check_recording(nominal, measured, checks);
  check_promises(false, measured, checks);
  return {direction, 0.0, checks.take()};
}

/// The bottleneck of a stage, and how it becomes the one of the next.
void verify_bottleneck(const DirectionProfile& nominal, std::size_t i, const DirectionProfile& emulated,
                       Direction direction, const Traffic& traffic, Checks& checks) {
  const Stage& now = nominal.stages[i];
  if (nominal.rate_trace) {
    if (i == 0) check_rate_trace(nominal, emulated, direction, traffic, checks);
    return;
  }
  if (now.conditions.rate_bit_per_s == 0) return;
  DirectionProfile single = emulated;
  single.stages = {Stage{0.0, emulated.stages[std::min(i, emulated.stages.size() - 1)].conditions}};
  check_rate(single, now.conditions, direction, traffic, checks);
  if (i + 1 == nominal.stages.size() || i + 1 >= emulated.stages.size()) return;
  if (nominal.stages[i + 1].conditions.rate_bit_per_s == now.conditions.rate_bit_per_s) return;
  single.stages.push_back(emulated.stages[i + 1]);
  check_change_of_rate(now, nominal.stages[i + 1], single, direction, traffic, checks);
}

}  // namespace

bool StageReport::good() const {
  return std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.good(); });
}

std::vector<StageReport> verify_direction(const DirectionProfile& nominal, const DirectionProfile& emulated,
                                          Direction direction, const Traffic& traffic) {
  if (nominal.recording && !nominal.loss_only)
    return {verify_recording(nominal, emulated, direction, traffic)};
  std::vector<StageReport> reports;
  const bool event_losses = std::any_of(nominal.events.begin(), nominal.events.end(),
                                        [](const Event& event) { return event.loss > 0; });
  for (std::size_t i = 0; i < nominal.stages.size(); ++i) {
    const Conditions& now = nominal.stages[i].conditions;
    DirectionProfile single = emulated;
    single.stages = {Stage{0.0, emulated.stages[std::min(i, emulated.stages.size() - 1)].conditions}};
    const Run measured = run(single, direction, traffic);
    Checks checks;
    check_delay(now, measured, traffic.rate_hz, checks);
    if (now.loss.model != LossModel::kTrace) {
      check_loss(now, measured, traffic.rate_hz, event_losses, checks);
    } else if (!(now.tcp_like && event_losses)) {
      check_loss_trace(nominal, measured, checks);
    }
    // Behind a bottleneck packets meet events later than they were sent.
    if (now.rate_bit_per_s == 0 && !nominal.rate_trace && !now.tcp_like)
      check_events(nominal.events, measured, checks);
    check_impairments(now, measured, checks);
    verify_bottleneck(nominal, i, emulated, direction, traffic, checks);
    check_promises(now.order == Order::kFifo, measured, checks);
    reports.push_back({direction, nominal.stages[i].from_s, checks.take()});
  }
  return reports;
}

std::vector<StageReport> verify(const Profile& profile, const Traffic& traffic) {
  auto reports = verify_direction(profile.forward, profile.forward, Direction::kForward, traffic);
  auto backward = verify_direction(profile.backward, profile.backward, Direction::kBackward, traffic);
  reports.insert(reports.end(), std::make_move_iterator(backward.begin()),
                 std::make_move_iterator(backward.end()));
  return reports;
}

}  // namespace telekerf::netem
