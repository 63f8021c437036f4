// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/bottleneck_checks.h"

#include <algorithm>
#include <cmath>

#include "netem/verify/bounds.h"

namespace telekerf::netem {
namespace {

/// At least two fit into the queue.
std::uint32_t fitting_bytes(std::uint32_t wanted, const Conditions& now) {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(wanted, now.queue_bytes / 2));
}

}  // namespace

void check_rate(const DirectionProfile& emulated, const Conditions& nominal, Direction direction,
                Traffic traffic, Checks& checks) {
  traffic.packet_bytes = fitting_bytes(traffic.packet_bytes, nominal);
  const double packet_bits = 8.0 * traffic.packet_bytes;
  traffic.rate_hz = 2.0 * nominal.rate_bit_per_s / packet_bits;
  const double queue_packets = 8.0 * static_cast<double>(nominal.queue_bytes) / packet_bits;
  traffic.packets =
      std::min<std::uint64_t>(traffic.packets, static_cast<std::uint64_t>(20'000 + 40 * queue_packets));
  const Run overload = run(emulated, direction, traffic);
  std::uint64_t passed = 0;
  std::int64_t longest_ns = 0;
  for (const Sent& sent : overload.sent) {
    passed += !sent.outcome.queue_full;
    longest_ns = std::max(longest_ns, sent.outcome.queued_ns);
  }
  const double duration_s = static_cast<double>(traffic.packets) / traffic.rate_hz;
  const double slack = (queue_packets + 2) * packet_bits / duration_s + 0.001 * nominal.rate_bit_per_s;
  checks.near("rate under overload", "kbit/s", static_cast<double>(passed) * packet_bits / duration_s / 1e3,
              nominal.rate_bit_per_s / 1e3, slack / 1e3);
  const double full_s = 8.0 * static_cast<double>(nominal.queue_bytes) / nominal.rate_bit_per_s;
  const bool filled = passed < traffic.packets;
  const double packet_s = packet_bits / nominal.rate_bit_per_s;
  constexpr double kRounding_s = 1e-9;
  const double least_s = filled ? std::max(0.0, full_s - 2 * packet_s - kRounding_s) : 0.0;
  checks.within("longest stay in the queue", "ms", static_cast<double>(longest_ns) * 1e-6, full_s * 1e3,
                least_s * 1e3, (full_s + kRounding_s) * 1e3);
}

void check_change_of_rate(const Stage& before, const Stage& after, const DirectionProfile& emulated,
                          Direction direction, Traffic traffic, Checks& checks) {
  const double first_rate = before.conditions.rate_bit_per_s;
  const double second_rate = after.conditions.rate_bit_per_s;
  traffic.packet_bytes = fitting_bytes(traffic.packet_bytes, before.conditions);
  const double packet_bits = 8.0 * traffic.packet_bytes;
  // The queue is full when the rate changes.
  const double full_s = 8.0 * static_cast<double>(before.conditions.queue_bytes) / first_rate;
  DirectionProfile two = emulated;
  two.events.clear();
  two.stages[1].from_s = std::min(2.0 * full_s, after.from_s - before.from_s);
  const double change_s = two.stages[1].from_s;
  traffic.rate_hz = 2.0 * std::max(first_rate, second_rate) / packet_bits;
  constexpr double kMost = 200'000;
  const double duration_s = change_s + std::max(0.5 * change_s, 100.0 / traffic.rate_hz);
  traffic.rate_hz = std::min(traffic.rate_hz, kMost / duration_s);
  traffic.packets = static_cast<std::uint64_t>(duration_s * traffic.rate_hz);
  const Run changing = run(two, direction, traffic);

  std::uint64_t astray = 0;
  double free_s = 0.0;
  for (const Sent& sent : changing.sent) {
    if (sent.outcome.queue_full) continue;
    const double in_s = static_cast<double>(sent.in_ns) * kNs;
    double begins_s = std::max(in_s, free_s);
    double bits = packet_bits;
    if (begins_s < change_s) {
      const double until_change = std::min(bits, (change_s - begins_s) * first_rate);
      begins_s += until_change / first_rate;
      bits -= until_change;
    }
    if (bits > 0) begins_s = std::max(begins_s, change_s) + (second_rate > 0 ? bits / second_rate : 0.0);
    free_s = begins_s;
    constexpr double kRounding_s = 1e-6;
    astray += std::abs(static_cast<double>(sent.in_ns + sent.outcome.queued_ns) * kNs - free_s) > kRounding_s;
  }
  checks.none("left otherwise than the changing rate", astray);
}

void check_rate_trace(const DirectionProfile& nominal, const DirectionProfile& emulated, Direction direction,
                      Traffic traffic, Checks& checks) {
  const RateTrace& trace = *nominal.rate_trace;
  DirectionProfile alone = emulated;
  alone.events.clear();
  traffic.packet_bytes = fitting_bytes(traffic.packet_bytes, nominal.stages.front().conditions);
  const double length_s = static_cast<double>(trace.at_ns.back()) * kNs;
  const double mean_bytes_per_s =
      static_cast<double>(trace.at_ns.size()) * static_cast<double>(kOpportunity_bytes) / length_s;
  traffic.rate_hz = 2.0 * mean_bytes_per_s / traffic.packet_bytes;
  traffic.packets = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(1.5 * length_s * traffic.rate_hz),
                                              1'000, traffic.packets);
  const Run overload = run(alone, direction, traffic);
  const bool repeats = nominal.trace_end == TraceEnd::kRepeat;
  std::uint64_t astray = 0;
  std::uint64_t after = 0;
  std::size_t next = 0;       // opportunity, ...
  std::int64_t round_ns = 0;  // ... in the round that begins here
  std::int64_t left_bytes = kOpportunity_bytes;
  const auto skip = [&] {
    left_bytes = kOpportunity_bytes;
    if (++next < trace.at_ns.size() || !repeats) return;
    next = 0;
    round_ns += trace.at_ns.back();
  };
  for (const Sent& sent : overload.sent) {
    if (sent.outcome.queue_full) continue;
    while (next < trace.at_ns.size() && round_ns + trace.at_ns[next] < sent.in_ns) skip();
    std::int64_t bytes = traffic.packet_bytes;
    while (next < trace.at_ns.size() && bytes > left_bytes) {
      bytes -= left_bytes;
      skip();
    }
    if (next >= trace.at_ns.size()) {
      ++after;
      astray += !sent.outcome.after_trace;
      continue;
    }
    astray += sent.in_ns + sent.outcome.queued_ns != round_ns + trace.at_ns[next];
    left_bytes -= bytes;
    if (left_bytes == 0) skip();
  }
  checks.none("left otherwise than the recorded rate", astray);
  checks.note("sent after the recording's end", "packets", static_cast<double>(after));
}

}  // namespace telekerf::netem
