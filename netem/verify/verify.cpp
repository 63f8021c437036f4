// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/verify.h"

#include <algorithm>
#include <iterator>

#include "netem/verify/delay_checks.h"
#include "netem/verify/impairment_checks.h"
#include "netem/verify/loss_checks.h"

namespace telekerf::netem {
namespace {

StageReport verify_recording(const DirectionProfile& nominal, const DirectionProfile& emulated,
                             Direction direction, const Traffic& traffic) {
  const Run measured = run(emulated, direction, traffic);
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < measured.sent.size(); ++i) {
    const RecordedOutcome& recorded = (*nominal.recording)[i % nominal.recording->size()];
    const PacketOutcome& outcome = measured.sent[i].outcome;
    const bool same = outcome.lost() == recorded.lost &&
                      (recorded.lost || (outcome.due_ns - measured.sent[i].in_ns == recorded.delay_ns &&
                                         outcome.duplicated == recorded.duplicated &&
                                         outcome.corrupted == recorded.corrupted));
    differing += !same;
  }
  Checks checks;
  checks.none("other than recorded", differing);
  check_promises(false, measured, checks);
  return {direction, 0.0, checks.take()};
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
      check_loss(now, measured, event_losses, checks);
    } else if (!(now.tcp_like && event_losses)) {
      check_loss_trace(*nominal.recording, measured, checks);
    }
    // Behind a bottleneck packets meet events later than they were sent.
    if (now.rate_bit_per_s == 0 && !now.tcp_like) check_events(nominal.events, measured, checks);
    check_impairments(now, measured, checks);
    if (now.rate_bit_per_s > 0) check_rate(single, now, direction, traffic, checks);
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
