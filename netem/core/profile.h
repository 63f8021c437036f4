// SPDX-License-Identifier: Apache-2.0
// A network, written down: what happens to packets in either direction. TOML files; netem/README.md explains
// the keys.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/runtime/enum_table.h"

namespace telekerf::netem {

/// Laws of the one-way delay. uniform, normal, laplace: `delay_s` is the centre, cut off at zero delay (the
/// law under the condition delay >= 0). gamma, lognormal, pareto: `delay_s` is the floor and the law is added
/// on top. table: quantiles added to `delay_s`.
enum class DelayDistribution { kConstant, kUniform, kNormal, kLaplace, kGamma, kLognormal, kPareto, kTable };

inline constexpr EnumRow<DelayDistribution> kDelayDistributionRows[] = {
    {"constant", DelayDistribution::kConstant, "always the same"},
    {"uniform", DelayDistribution::kUniform, "anything within sqrt(3) jitters alike"},
    {"normal", DelayDistribution::kNormal, "Gaussian"},
    {"laplace", DelayDistribution::kLaplace, "a peak with two exponential tails"},
    {"gamma", DelayDistribution::kGamma, "a floor and a sum of exponential waits"},
    {"lognormal", DelayDistribution::kLognormal, "a floor and a heavy tail"},
    {"pareto", DelayDistribution::kPareto, "a floor and a power-law tail"},
    {"table", DelayDistribution::kTable, "quantiles of a measurement"},
};
inline constexpr EnumTable<DelayDistribution> kDelayDistributions{kDelayDistributionRows};

struct DelayParameters {
  DelayDistribution distribution = DelayDistribution::kConstant;
  double delay_s = 0.0;
  double jitter_s = 0.0;  ///< standard deviation of the law (of symmetric laws before the cut at zero)
  double shape = 0.0;     ///< gamma: k; lognormal: sigma of the logarithm; pareto: tail index > 2
  /// The Gaussian behind the law (copula) keeps exp(-dt / correlation_s) of itself over dt; 0: packets are
  /// independent.
  double correlation_s = 0.0;
  std::vector<double> table_p;  ///< table: ascending from 0 to 1
  std::vector<double> table_s;  ///< table: quantiles at `table_p`, not descending
  bool operator==(const DelayParameters&) const = default;
};

enum class LossModel { kNone, kBernoulli, kGilbertElliott, kFourState, kTrace };

inline constexpr EnumRow<LossModel> kLossModelRows[] = {
    {"none", LossModel::kNone, "nothing is lost"},
    {"bernoulli", LossModel::kBernoulli, "each packet by itself"},
    {"gilbert-elliott", LossModel::kGilbertElliott, "a good and a bad state"},
    {"four-state", LossModel::kFourState, "bursts with pauses, and single losses"},
    {"trace", LossModel::kTrace, "as recorded"},
};
inline constexpr EnumTable<LossModel> kLossModels{kLossModelRows};

struct LossParameters {
  LossModel model = LossModel::kNone;
  double loss =
      0.0;  ///< bernoulli: probability; gilbert-elliott with burst_s: share of time in the bad state
  /// gilbert-elliott in time: mean length of a burst, in which everything is lost, and nothing outside;
  /// 0: by packets.
  double burst_s = 0.0;
  /// Gilbert-Elliott: good -> bad, bad -> good, and the shares *delivered* in the bad (h) and good (k) state.
  double ge_p = 0.0, ge_r = 1.0, ge_h = 0.0, ge_k = 1.0;
  /// 1 delivered, 2 delivered inside a burst, 3 lost in a burst, 4 lost alone (4 -> 1 always).
  double p13 = 0.0, p31 = 1.0, p32 = 0.0, p23 = 0.0, p14 = 0.0;
};

/// fifo: nothing overtakes. free: jitter alone decides. reorder: fifo, but a chosen packet overtakes
/// `reorder_gap` packets before it as far as they are still under way.
enum class Order { kFifo, kFree, kReorder };

inline constexpr EnumRow<Order> kOrderRows[] = {{"fifo", Order::kFifo, "nothing overtakes"},
                                                {"free", Order::kFree, "jitter alone decides"},
                                                {"reorder", Order::kReorder, "chosen packets overtake"}};
inline constexpr EnumTable<Order> kOrders{kOrderRows};

/// Packets leave only at slot starts (n * period + uniform in [0, jitter]); 0 packets or bytes: no limit.
struct Slots {
  double period_s = 0.0;  ///< 0: no slots
  double jitter_s = 0.0;
  std::int64_t packets = 0;
  std::int64_t bytes = 0;
};

/// The network at one time.
struct Conditions {
  DelayParameters delay;
  LossParameters loss;
  Order order = Order::kFifo;
  double reorder = 0.0;  ///< probability
  int reorder_gap = 1;   ///< packets, <= kMaxReorderGap
  bool tcp_like =
      false;  ///< nothing is lost: a loss becomes a wait of rto, 3 rto, 7 rto ... for all that follow
  double rto_s = 0.2;
  double duplicate = 0.0;        ///< probability
  double corrupt = 0.0;          ///< probability that one bit flips
  double rate_bit_per_s = 0.0;   ///< 0: unlimited
  std::int64_t queue_bytes = 0;  ///< waiting before the bottleneck; only with a rate
  Slots slots;
};
inline constexpr int kMaxReorderGap = 64;

struct Stage {
  double from_s = 0.0;  ///< since the profile began
  Conditions conditions;
};

/// Something that comes back: during [first + n every, + duration) packets wait longer (one uniform draw per
/// occurrence) and are lost with probability `loss`; loss = 1 is an outage. With `hold` they wait for its
/// end instead: a pause in which nothing is lost.
struct Event {
  double first_s = 0.0;  ///< may lie before the profile's beginning
  double every_s = 0.0;  ///< 0: once
  double duration_s = 0.0;
  double add_delay_min_s = 0.0;
  double add_delay_max_s = 0.0;
  double loss = 0.0;
  bool hold = false;
  /// Events of the same number, in either direction, draw alike; 0: on its own.
  std::uint64_t coupling = 0;
};
inline constexpr std::size_t kMaxEvents = 16;

/// The recorded outcome of one packet.
struct RecordedOutcome {
  std::int64_t in_ns = 0;
  std::int64_t delay_ns = 0;
  bool lost = false;
  bool duplicated = false;
  bool corrupted = false;
};
using Recording = std::vector<RecordedOutcome>;

/// A recorded rate, as mahimahi writes it: at each of these times up to kOpportunity_bytes may leave.
struct RateTrace {
  std::vector<std::int64_t> at_ns;  ///< ascending, from 0; the last is above 0
};
inline constexpr std::int64_t kOpportunity_bytes = 1500;

/// What becomes of packets after the end of what was recorded.
enum class TraceEnd { kLose, kRepeat };

inline constexpr EnumRow<TraceEnd> kTraceEndRows[] = {
    {"lose", TraceEnd::kLose, "nothing gets through any more"},
    {"repeat", TraceEnd::kRepeat, "it begins anew"}};
inline constexpr EnumTable<TraceEnd> kTraceEnds{kTraceEndRows};

struct DirectionProfile {
  std::vector<Stage> stages{Stage{}};  ///< ascending; the first begins at 0
  std::vector<Event> events;           ///< at most kMaxEvents
  /// Replayed by time: a packet fares as the recorded one that was sent last; with `loss_only` only its
  /// losses.
  std::shared_ptr<const Recording> recording;
  bool loss_only = false;
  std::shared_ptr<const RateTrace> rate_trace;  ///< instead of the stages' rates; queue_bytes is the stages'
  TraceEnd trace_end = TraceEnd::kLose;
};

struct Profile {
  std::string name;
  std::string description;
  std::string source;
  DirectionProfile forward;   ///< operator -> slave
  DirectionProfile backward;  ///< slave -> operator
};

/// A shipped name, a TOML file, a recorded trace (*.csv, both directions), or recorded rates (*.up or *.down
/// of mahimahi: both stand side by side; forward is the downlink). Throws StartupError: missing file, unknown
/// or misplaced key, value out of bounds, contradictory models.
Profile load_profile(const std::string& name_or_path);

/// How long the recordings of the profile last and what comes then, in a sentence; empty: it has none.
std::string trace_note(const Profile& profile);

/// The same from text; `name` stands in messages, relative trace files are sought in `folder`.
Profile parse_profile(const std::string& text, const std::string& name, const std::string& folder = ".");

/// Half of `rtt_s` each way, normal jitter (one way, standard deviation), independent losses, FIFO. Throws
/// StartupError.
Profile simple_profile(double rtt_s, double jitter_s, double loss);

}  // namespace telekerf::netem
