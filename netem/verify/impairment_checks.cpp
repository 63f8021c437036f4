// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/impairment_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "netem/core/compiled_profile.h"
#include "netem/verify/bounds.h"

namespace telekerf::netem {
namespace {

void check_slots(const Slots& slots, const Run& run, Checks& checks) {
  const std::int64_t period_ns = std::llround(slots.period_s * 1e9);
  const std::int64_t jitter_ns = std::llround(slots.jitter_s * 1e9);
  std::uint64_t astray = 0;
  std::uint64_t crowded = 0;
  std::int64_t last_ns = -1;
  std::int64_t packets = 0;
  for (const Sent& sent : run.sent) {
    if (sent.outcome.lost()) continue;
    const std::int64_t phase_ns = sent.outcome.due_ns % period_ns;
    astray += phase_ns > jitter_ns && !(jitter_ns == period_ns);
    packets = sent.outcome.due_ns == last_ns ? packets + 1 : 1;
    last_ns = sent.outcome.due_ns;
    crowded += slots.packets > 0 && packets > slots.packets;
  }
  checks.none("outside the slots", astray);
  checks.none("too many in a slot", crowded);
}

}  // namespace

void check_events(const std::vector<Event>& events, const Run& run, Checks& checks) {
  std::vector<CompiledProfile::Event> compiled(events.begin(), events.end());
  for (std::size_t e = 0; e < events.size(); ++e) {
    std::uint64_t inside = 0;  // with no other event that loses packets
    std::uint64_t lost = 0;
    std::uint64_t outside_range = 0;
    std::int64_t last = -1;
    double added_s = 0.0;
    double occurrences = 0.0;  // with no other event that delays them
    for (const Sent& sent : run.sent) {
      const std::int64_t occurrence = compiled[e].window(sent.in_ns).occurrence;
      if (occurrence < 0) continue;
      bool loses_alone = true;
      bool delays_alone = true;
      double least_s = 0.0;
      double most_s = 0.0;
      for (std::size_t any = 0; any < compiled.size(); ++any) {
        const CompiledProfile::Window window = compiled[any].window(sent.in_ns);
        if (window.occurrence < 0) continue;
        const double held_s =
            events[any].hold ? static_cast<double>(window.until_ns - sent.in_ns) * kNs : 0.0;
        least_s += held_s + events[any].add_delay_min_s;
        most_s += held_s + events[any].add_delay_max_s;
        if (any == e) continue;
        loses_alone = loses_alone && events[any].loss == 0;
        delays_alone = delays_alone && events[any].add_delay_max_s == 0 && !events[any].hold;
      }
      inside += loses_alone;
      lost += loses_alone && sent.outcome.lost_by_event;
      const double event_s = static_cast<double>(sent.outcome.event_ns) * kNs;
      outside_range += event_s < least_s - kNs || event_s > most_s + kNs;
      if (delays_alone && occurrence != last) {
        added_s += event_s;
        occurrences += 1.0;
        last = occurrence;
      }
    }
    const std::string name = fmt::format("event {}", e);
    checks.fraction(name + " loss", lost, inside, events[e].loss);
    checks.none(name + " delay outside its range", outside_range);
    const double range_s = events[e].add_delay_max_s - events[e].add_delay_min_s;
    if (range_s > 0 && occurrences > 0) {
      const double half_s = range_s * std::sqrt(kLogAlarm / (2 * occurrences));  // Hoeffding
      checks.near(name + " added delay", "ms", added_s / occurrences * 1e3,
                  500 * (events[e].add_delay_min_s + events[e].add_delay_max_s), half_s * 1e3);
    }
  }
  if (events.empty()) return;
  std::uint64_t strays = 0;
  for (const Sent& sent : run.sent) {
    bool any = false;
    for (const auto& event : compiled) any = any || event.window(sent.in_ns).occurrence >= 0;
    strays += !any && (sent.outcome.event_ns != 0 || sent.outcome.lost_by_event);
  }
  checks.none("touched outside events", strays);
}

void check_impairments(const Conditions& nominal, const Run& run, Checks& checks) {
  std::uint64_t decided = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t could_overtake = 0;  // only what is under way can be overtaken
  std::uint64_t reordered = 0;
  std::int64_t last_in_order_ns = 0;
  for (const Sent& sent : run.sent) {
    if (sent.outcome.lost()) continue;
    ++decided;
    duplicated += sent.outcome.duplicated;
    corrupted += sent.outcome.corrupted;
    could_overtake += last_in_order_ns > sent.in_ns;
    reordered += sent.outcome.reordered;
    if (!sent.outcome.reordered) last_in_order_ns = sent.outcome.due_ns;
  }
  checks.fraction("duplicated", duplicated, decided, nominal.duplicate);
  checks.fraction("corrupted", corrupted, decided, nominal.corrupt);
  if (nominal.order == Order::kReorder) {
    checks.fraction("chosen to overtake", reordered, could_overtake, nominal.reorder);
  }
  if (nominal.slots.period_s > 0) check_slots(nominal.slots, run, checks);
}

void check_promises(bool fifo, const Run& run, Checks& checks) {
  const Counters& c = run.counters;
  checks.none("arrived early", run.early);
  checks.none("due time altered", run.altered);
  if (fifo) {
    checks.none("out of order", run.out_of_order);
  } else {
    checks.note("arrived out of order", "",
                static_cast<double>(run.out_of_order) / std::max(1.0, double(run.kept)));
  }
  checks.none("unaccounted for",
              c.pushed + c.duplicated - c.delivered - c.lost - c.queue_full - c.overflowed - c.after_trace);
  checks.none("beyond capacity", c.overflowed);
  checks.note("delivered delay mean", "ms", run.delivered_mean_s * 1e3);
}

}  // namespace telekerf::netem
