// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/virtual_run.h"

#include <algorithm>
#include <cmath>

namespace telekerf::netem {

Run run(const DirectionProfile& profile, Direction direction, const Traffic& traffic) {
  Run run;
  run.sent.reserve(traffic.packets);
  Capacity capacity;
  capacity.bytes = 0;
  capacity.packets = 1U << 18;
  Emulator emulator(profile, {traffic.seed, 0, direction}, capacity);
  std::uint64_t newest = 0;
  double sum_s = 0.0;
  const auto receive = [&](std::int64_t until_ns) {
    while (const auto deadline = emulator.next_deadline()) {
      if (*deadline > until_ns) break;
      const auto delivery = emulator.pop(*deadline);
      if (!delivery) break;
      const Sent& sent = run.sent[delivery->tag];
      run.altered += delivery->due_ns != sent.outcome.due_ns;
      run.early += !sent.outcome.reordered &&
                   delivery->due_ns < sent.in_ns + sent.outcome.drawn_ns + sent.outcome.event_ns;
      if (delivery->duplicate) continue;
      run.out_of_order += delivery->tag < newest;
      newest = std::max(newest, delivery->tag);
      sum_s += static_cast<double>(delivery->due_ns - delivery->in_ns) * 1e-9;
      ++run.kept;
    }
  };
  for (std::uint64_t i = 0; i < traffic.packets; ++i) {
    const auto now_ns =
        static_cast<std::int64_t>(std::llround(static_cast<double>(i) * 1e9 / traffic.rate_hz));
    receive(now_ns - 1);
    run.sent.push_back({now_ns, emulator.push(now_ns, traffic.packet_bytes, i)});
  }
  receive(INT64_MAX);
  run.counters = emulator.counters();
  run.delivered_mean_s = run.kept > 0 ? sum_s / static_cast<double>(run.kept) : 0.0;
  return run;
}

}  // namespace telekerf::netem
