// SPDX-License-Identifier: Apache-2.0
#include "netem/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "netem/bounds.h"
#include "netem/emulator.h"

namespace telekerf::netem {
namespace {

constexpr double kWinsorScore =
    3.5;  // means and deviations are taken within these normal scores of the nominal law
constexpr double kNs = 1e-9;

struct Sent {
  std::int64_t in_ns;
  Fate fate;
};

/// Everything that one run leaves behind.
struct Run {
  std::vector<Sent> sent;
  std::uint64_t early = 0;         ///< came before its due time
  std::uint64_t altered = 0;       ///< came with another due time than decided
  std::uint64_t out_of_order = 0;  ///< came after a packet that was sent later
  std::uint64_t kept = 0;
  double delivered_mean_s = 0.0;
  Counters counters;
};

/// Virtual time: packets at a constant rate; every delivery is taken at its deadline.
Run run(const DirectionProfile& profile, Direction direction, const VerifyOptions& options, double rate_hz,
        std::uint64_t packets) {
  Run run;
  run.sent.reserve(packets);
  Capacity capacity;
  capacity.bytes = 0;
  capacity.packets = 1U << 18;
  Emulator emulator(profile, {options.seed, 0, direction}, capacity);
  std::uint64_t newest = 0;
  double sum_s = 0.0;
  const auto receive = [&](std::int64_t until_ns) {
    while (const auto deadline = emulator.next_deadline()) {
      if (*deadline > until_ns) break;
      const auto delivery = emulator.pop(*deadline);
      if (!delivery) break;
      const Sent& sent = run.sent[delivery->tag];
      run.altered += delivery->due_ns != sent.fate.due_ns;
      run.early +=
          !sent.fate.reordered && delivery->due_ns < sent.in_ns + sent.fate.drawn_ns + sent.fate.event_ns;
      if (delivery->duplicate) continue;
      run.out_of_order += delivery->tag < newest;
      newest = std::max(newest, delivery->tag);
      sum_s += static_cast<double>(delivery->due_ns - delivery->in_ns) * kNs;
      ++run.kept;
    }
  };
  for (std::uint64_t i = 0; i < packets; ++i) {
    const auto now_ns = static_cast<std::int64_t>(std::llround(static_cast<double>(i) * 1e9 / rate_hz));
    receive(now_ns - 1);
    run.sent.push_back({now_ns, emulator.push(now_ns, options.packet_bytes, i)});
  }
  receive(INT64_MAX);
  run.counters = emulator.counters();
  run.delivered_mean_s = run.kept > 0 ? sum_s / static_cast<double>(run.kept) : 0.0;
  return run;
}

class Checks {
 public:
  void within(const std::string& name, const std::string& unit, double measured, double nominal, double low,
              double high) {
    checks_.push_back({name, unit, measured, nominal, low, high, true});
  }
  void near(const std::string& name, const std::string& unit, double measured, double nominal,
            double half_width) {
    within(name, unit, measured, nominal, nominal - half_width, nominal + half_width);
  }
  void none(const std::string& name, std::uint64_t count) {
    within(name, "packets", static_cast<double>(count), 0.0, 0.0, 0.0);
  }
  void note(const std::string& name, const std::string& unit, double measured) {
    checks_.push_back({name, unit, measured, 0.0, 0.0, 0.0, false});
  }
  /// A share of independent decisions.
  void share(const std::string& name, std::uint64_t count, std::uint64_t of, double nominal,
             double memory = 0.0) {
    if (of == 0) return;
    if (nominal == 0) return none(name, count);
    const auto n = static_cast<double>(of);
    near(name, "", static_cast<double>(count) / n, nominal,
         bernstein(n, nominal * (1 - nominal), 1.0, memory));
  }
  std::vector<Check> take() { return std::move(checks_); }

 private:
  std::vector<Check> checks_;
};

void check_quantiles(const DelayLaw& law, std::vector<std::int64_t> drawn_ns, Checks& checks) {
  std::sort(drawn_ns.begin(), drawn_ns.end());
  const auto n = static_cast<double>(drawn_ns.size());
  for (const double p : {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999}) {
    const double half = bernstein(n, p * (1 - p), 1.0, law.correlation) + 1.0 / n;
    const auto quantile_ms = [&](double share) {
      share = std::clamp(share, 0.0, 1.0);
      constexpr double kEnd = 1e-19;  // the last number that can be drawn
      return delay_quantile(law, std::max(share, kEnd), std::max(1.0 - share, kEnd)) * 1e3;
    };
    const auto at = std::min(drawn_ns.size() - 1, static_cast<std::size_t>(p * n));
    constexpr double kRounding_ms = 2e-6;
    checks.within(fmt::format("delay p{:g}", 100 * p), "ms", static_cast<double>(drawn_ns[at]) * 1e-6,
                  quantile_ms(p), quantile_ms(p - half) - kRounding_ms, quantile_ms(p + half) + kRounding_ms);
  }
}

/// Means within inner normal scores: there every value is bounded, so the bounds hold for the heaviest tail.
void check_moments(const DelayLaw& law, const std::vector<std::int64_t>& drawn_ns, Checks& checks) {
  const auto n = static_cast<double>(drawn_ns.size());
  const Moments nominal = delay_moments(law, kWinsorScore);
  const double low_s = delay_at_normal(law, -kWinsorScore);
  const double high_s = delay_at_normal(law, kWinsorScore);
  double sum = 0.0;
  double squares = 0.0;
  for (const std::int64_t ns : drawn_ns) {
    const double x = std::clamp(static_cast<double>(ns) * kNs, low_s, high_s) - nominal.mean_s;
    sum += x;
    squares += x * x;
  }
  const double variance = nominal.sd_s * nominal.sd_s;
  const double reach = std::max(high_s - nominal.mean_s, nominal.mean_s - low_s);
  constexpr double kRounding_s = 1e-9;
  checks.near("delay mean", "ms", (nominal.mean_s + sum / n) * 1e3, nominal.mean_s * 1e3,
              (bernstein(n, variance, reach, law.correlation) + kRounding_s) * 1e3);
  const double square_variance = nominal.fourth_s4 - variance * variance;
  const double half = bernstein(n, square_variance, reach * reach, law.correlation) + 2 * reach * kRounding_s;
  checks.within("delay sd", "ms", std::sqrt(squares / n) * 1e3, nominal.sd_s * 1e3,
                std::sqrt(std::max(0.0, variance - half)) * 1e3, std::sqrt(variance + half) * 1e3);
}

void check_correlation(const DelayLaw& law, const std::vector<std::int64_t>& drawn_ns, Checks& checks) {
  if (drawn_ns.size() < 100) return;
  const DelayTable table(law);
  double products = 0.0;
  double squares = 0.0;
  double last = table.normal_score(drawn_ns.front());
  for (std::size_t i = 1; i < drawn_ns.size(); ++i) {
    const double score = table.normal_score(drawn_ns[i]);
    products += score * last;
    squares += 0.5 * (score * score + last * last);
    last = score;
  }
  const auto n = static_cast<double>(drawn_ns.size());
  const double rho = law.correlation;
  checks.near("delay lag-1 correlation", "", products / squares, rho,
              std::sqrt(2 * kLogAlarm * (1 - rho * rho) / n) + 4 * kLogAlarm / n);
}

/// Normal scores can be told from delays only where the law has neither steps nor flat stretches.
bool is_invertible(const DelayLaw& law) {
  if (law.law != Law::kTable) {
    // Where the delay hardly grows from score to score, whole nanoseconds tell nothing.
    constexpr double kStep = 0.25;
    constexpr double kLeastRise_s = 25e-9;
    for (int i = -8; i < 14; ++i) {
      if (delay_at_normal(law, (i + 1) * kStep) - delay_at_normal(law, i * kStep) < kLeastRise_s) return false;
    }
    return true;
  }
  for (std::size_t i = 1; i < law.table_s.size(); ++i) {
    if (law.table_s[i] - law.table_s[i - 1] < 1e-5) return false;
  }
  return true;
}

void check_delay(const Conditions& nominal, const Run& run, const VerifyOptions& options, Checks& checks) {
  const DelayLaw& law = nominal.delay;
  if (law.law == Law::kConstant) {
    const std::int64_t expected_ns = std::llround(law.delay_s * 1e9);
    std::uint64_t others = 0;
    for (const Sent& sent : run.sent) others += sent.fate.drawn_ns != expected_ns;
    checks.near("delay", "ms", static_cast<double>(run.sent.front().fate.drawn_ns) * 1e-6, law.delay_s * 1e3,
                1e-6);
    checks.none("other delays than that", others);
  } else {
    std::vector<std::int64_t> drawn_ns;
    drawn_ns.reserve(run.sent.size());
    for (const Sent& sent : run.sent) drawn_ns.push_back(sent.fate.drawn_ns);
    check_moments(law, drawn_ns, checks);
    if (is_invertible(law)) check_correlation(law, drawn_ns, checks);
    check_quantiles(law, std::move(drawn_ns), checks);
  }
  if (nominal.order == Order::kFree && law.law != Law::kConstant) {
    std::uint64_t overtaking = 0;
    for (std::size_t i = 1; i < run.sent.size(); ++i) {
      overtaking += run.sent[i].in_ns + run.sent[i].fate.drawn_ns <
                    run.sent[i - 1].in_ns + run.sent[i - 1].fate.drawn_ns;
    }
    const auto n = static_cast<double>(run.sent.size() - 1);
    const double p = overtaking_probability(law, 1.0 / options.rate_hz);
    // A function of two neighbours: its covariances reach one packet further than the delay's own, so its
    // variance grows by 1 + 2 / (1 - rho) at most; 1 / (2 - rho) is the memory that means the same to
    // bernstein().
    constexpr double kIntegration = 2e-4;
    const double half = bernstein(n, p * (1 - p), 1.0, 1 / (2 - law.correlation)) + kIntegration;
    checks.near("overtakes predecessor", "", static_cast<double>(overtaking) / n, p, half);
  }
}

void check_burst(const LossLaw& law, const LossChain& chain, std::uint64_t lost, std::uint64_t bursts,
                 double n, Checks& checks) {
  const double nominal = mean_burst(chain);
  const auto count = static_cast<double>(bursts);
  const double measured = static_cast<double>(lost) / count;
  const bool renewal = law.model == LossModel::kBernoulli ||
                       (law.model == LossModel::kGilbertElliott && law.ge_h == 0 && law.ge_k == 1);
  double half;
  if (renewal) {  // independent geometric lengths
    const double variance = nominal * std::max(0.0, nominal - 1);
    half = std::sqrt(2 * kLogAlarm * variance / count) + 2 * nominal * kLogAlarm / count;
  } else {
    const double memory = chain_memory(chain);
    const double spread =
        (1 + memory) / (1 - memory);  // bernstein() multiplies by it; the variance has it already
    half = bernstein(n, burst_variance(chain) / spread, nominal, memory) * n / count;
  }
  checks.near("mean burst", "packets", measured, nominal, half);
}

void check_loss(const Conditions& nominal, const Run& run, bool event_losses, Checks& checks) {
  const LossChain chain = loss_chain(nominal.loss);
  const double p = mean_loss(chain);
  const auto n = static_cast<double>(run.sent.size());
  std::uint64_t lost = 0;
  std::uint64_t bursts = 0;
  bool before = false;
  for (const Sent& sent : run.sent) {
    const bool now = sent.fate.lost_by_model || sent.fate.retransmissions > 0;
    lost += now;
    bursts += now && !before;
    before = now;
  }
  if (nominal.tcp_like) {
    checks.none("lost on a TCP-like link", run.counters.lost);
    if (!event_losses) checks.share("retransmitted", lost, run.sent.size(), p, chain_memory(chain));
    return;
  }
  if (p == 0) {
    checks.none("lost by the model", lost);
    return;
  }
  checks.share("loss", lost, run.sent.size(), p, chain_memory(chain));
  if (bursts > 0 && p < 1) check_burst(nominal.loss, chain, lost, bursts, n, checks);
}

void check_events(const std::vector<Event>& events, const Run& run, Checks& checks) {
  std::vector<Plan::Event> plans(events.begin(), events.end());
  for (std::size_t e = 0; e < events.size(); ++e) {
    std::uint64_t inside = 0;
    std::uint64_t lost = 0;
    std::uint64_t outside_range = 0;
    std::int64_t last = -1;
    double added_s = 0.0;
    double occurrences = 0.0;
    for (const Sent& sent : run.sent) {
      const std::int64_t occurrence = plans[e].window(sent.in_ns).occurrence;
      bool alone = occurrence >= 0;
      for (std::size_t other = 0; other < plans.size(); ++other) {
        if (other != e && plans[other].window(sent.in_ns).occurrence >= 0) alone = false;
      }
      if (!alone) continue;
      ++inside;
      lost += sent.fate.lost_by_event;
      const double event_s = static_cast<double>(sent.fate.event_ns) * kNs;
      outside_range += event_s < events[e].add_delay_min_s - kNs || event_s > events[e].add_delay_max_s + kNs;
      if (occurrence != last) {
        added_s += event_s;
        occurrences += 1.0;
        last = occurrence;
      }
    }
    if (inside == 0) continue;
    const std::string name = fmt::format("event {}", e);
    checks.share(name + " loss", lost, inside, events[e].loss);
    checks.none(name + " delay outside its range", outside_range);
    const double range_s = events[e].add_delay_max_s - events[e].add_delay_min_s;
    if (range_s > 0) {
      const double half_s = range_s * std::sqrt(kLogAlarm / (2 * occurrences));  // Hoeffding
      checks.near(name + " added delay", "ms", added_s / occurrences * 1e3,
                  500 * (events[e].add_delay_min_s + events[e].add_delay_max_s), half_s * 1e3);
    }
  }
  if (events.empty()) return;
  std::uint64_t strays = 0;
  for (const Sent& sent : run.sent) {
    bool any = false;
    for (const auto& plan : plans) any = any || plan.window(sent.in_ns).occurrence >= 0;
    strays += !any && (sent.fate.event_ns != 0 || sent.fate.lost_by_event);
  }
  checks.none("touched outside events", strays);
}

void check_the_rest(const Conditions& nominal, const Run& run, Checks& checks) {
  std::uint64_t decided = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t could_overtake = 0;  // only what is under way can be overtaken
  std::uint64_t reordered = 0;
  std::int64_t last_in_order_ns = 0;
  for (const Sent& sent : run.sent) {
    if (sent.fate.lost()) continue;
    ++decided;
    duplicated += sent.fate.duplicated;
    corrupted += sent.fate.corrupted;
    could_overtake += last_in_order_ns > sent.in_ns;
    reordered += sent.fate.reordered;
    if (!sent.fate.reordered) last_in_order_ns = sent.fate.due_ns;
  }
  checks.share("duplicated", duplicated, decided, nominal.duplicate);
  checks.share("corrupted", corrupted, decided, nominal.corrupt);
  if (nominal.order == Order::kReorder) {
    checks.share("chosen to overtake", reordered, could_overtake, nominal.reorder);
  }
  if (nominal.slots.period_s > 0) {
    const std::int64_t period_ns = std::llround(nominal.slots.period_s * 1e9);
    const std::int64_t jitter_ns = std::llround(nominal.slots.jitter_s * 1e9);
    std::uint64_t astray = 0;
    std::uint64_t crowded = 0;
    std::int64_t last_ns = -1;
    std::int64_t packets = 0;
    for (const Sent& sent : run.sent) {
      if (sent.fate.lost()) continue;
      const std::int64_t phase_ns = sent.fate.due_ns % period_ns;
      astray += phase_ns > jitter_ns && !(jitter_ns == period_ns);
      packets = sent.fate.due_ns == last_ns ? packets + 1 : 1;
      last_ns = sent.fate.due_ns;
      crowded += nominal.slots.packets > 0 && packets > nominal.slots.packets;
    }
    checks.none("outside the slots", astray);
    checks.none("too many in a slot", crowded);
  }
}

/// Twice the bottleneck's rate is offered, in packets of which at least two fit into its queue; what leaves must be
/// the rate, and nothing may stay longer than a full queue takes.
void check_rate(const DirectionProfile& emulated, const Conditions& nominal, Direction direction,
                VerifyOptions options, Checks& checks) {
  options.packet_bytes =
      static_cast<std::uint32_t>(std::min<std::int64_t>(options.packet_bytes, nominal.queue_bytes / 2));
  const double packet_bits = 8.0 * options.packet_bytes;
  const double offered_hz = 2.0 * nominal.rate_bit_per_s / packet_bits;
  const double queue_packets = 8.0 * static_cast<double>(nominal.queue_bytes) / packet_bits;
  const std::uint64_t packets =
      std::min<std::uint64_t>(options.packets, static_cast<std::uint64_t>(20'000 + 40 * queue_packets));
  const Run overload = run(emulated, direction, options, offered_hz, packets);
  std::uint64_t passed = 0;
  std::int64_t longest_ns = 0;
  for (const Sent& sent : overload.sent) {
    passed += !sent.fate.queue_full;
    longest_ns = std::max(longest_ns, sent.fate.queued_ns);
  }
  const double duration_s = static_cast<double>(packets) / offered_hz;
  const double slack = (queue_packets + 2) * packet_bits / duration_s + 0.001 * nominal.rate_bit_per_s;
  checks.near("rate under overload", "kbit/s", static_cast<double>(passed) * packet_bits / duration_s / 1e3,
              nominal.rate_bit_per_s / 1e3, slack / 1e3);
  const double full_s = 8.0 * static_cast<double>(nominal.queue_bytes) / nominal.rate_bit_per_s;
  const bool filled = passed < packets;
  const double packet_s = packet_bits / nominal.rate_bit_per_s;
  constexpr double kRounding_s = 1e-9;
  const double least_s = filled ? std::max(0.0, full_s - 2 * packet_s - kRounding_s) : 0.0;
  checks.within("longest stay in the queue", "ms", static_cast<double>(longest_ns) * 1e-6, full_s * 1e3, least_s * 1e3,
                (full_s + kRounding_s) * 1e3);
}

/// Losses alone from a recording: packet by packet.
void check_loss_trace(const Recording& recording, const Run& run, Checks& checks) {
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < run.sent.size(); ++i) {
    const Fate& fate = run.sent[i].fate;
    const bool lost = fate.lost_by_model || fate.retransmissions > 0;
    differing += lost != recording[i % recording.size()].lost;
  }
  checks.none("lost otherwise than recorded", differing);
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
              c.pushed + c.duplicated - c.delivered - c.lost - c.queue_full - c.overflowed);
  checks.none("beyond capacity", c.overflowed);
  checks.note("delivered delay mean", "ms", run.delivered_mean_s * 1e3);
}

StageReport verify_recording(const DirectionProfile& nominal, const DirectionProfile& emulated,
                             Direction direction, const VerifyOptions& options) {
  const Run measured = run(emulated, direction, options, options.rate_hz, options.packets);
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < measured.sent.size(); ++i) {
    const RecordedFate& recorded = (*nominal.recording)[i % nominal.recording->size()];
    const Fate& fate = measured.sent[i].fate;
    const bool same =
        fate.lost() == recorded.lost &&
        (recorded.lost || (fate.due_ns - measured.sent[i].in_ns == recorded.delay_ns &&
                           fate.duplicated == recorded.duplicated && fate.corrupted == recorded.corrupted));
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
                                          Direction direction, const VerifyOptions& options) {
  if (nominal.recording && !nominal.loss_only)
    return {verify_recording(nominal, emulated, direction, options)};
  std::vector<StageReport> reports;
  const bool event_losses = std::any_of(nominal.events.begin(), nominal.events.end(),
                                        [](const Event& event) { return event.loss > 0; });
  for (std::size_t i = 0; i < nominal.stages.size(); ++i) {
    const Conditions& now = nominal.stages[i].conditions;
    DirectionProfile single = emulated;
    single.stages = {Stage{0.0, emulated.stages[std::min(i, emulated.stages.size() - 1)].conditions}};
    const Run measured = run(single, direction, options, options.rate_hz, options.packets);
    Checks checks;
    check_delay(now, measured, options, checks);
    if (now.loss.model != LossModel::kTrace) {
      check_loss(now, measured, event_losses, checks);
    } else if (!(now.tcp_like && event_losses)) {
      check_loss_trace(*nominal.recording, measured, checks);
    }
    // Behind a bottleneck packets meet events later than they were sent.
    if (now.rate_bit_per_s == 0 && !now.tcp_like) check_events(nominal.events, measured, checks);
    check_the_rest(now, measured, checks);
    if (now.rate_bit_per_s > 0) check_rate(single, now, direction, options, checks);
    check_promises(now.order == Order::kFifo, measured, checks);
    reports.push_back({direction, nominal.stages[i].from_s, checks.take()});
  }
  return reports;
}

std::vector<StageReport> verify(const Profile& profile, const VerifyOptions& options) {
  auto reports = verify_direction(profile.forward, profile.forward, Direction::kForward, options);
  auto backward = verify_direction(profile.backward, profile.backward, Direction::kBackward, options);
  reports.insert(reports.end(), std::make_move_iterator(backward.begin()),
                 std::make_move_iterator(backward.end()));
  return reports;
}

}  // namespace telekerf::netem
