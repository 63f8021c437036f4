// SPDX-License-Identifier: Apache-2.0
#include "netem/core/conditions.h"

#include <algorithm>
#include <initializer_list>

namespace telekerf::netem {
namespace {

DelayParameters read_delay(const Section& section) {
  DelayParameters law;
  law.delay_s = section.number("delay_ms", 0.0, kDelay_ms) * kMillisecond_s;
  law.jitter_s = section.number("jitter_ms", 0.0, kDelay_ms) * kMillisecond_s;
  law.distribution = section.choice("distribution", DelayDistribution::kConstant, kDelayDistributions);
  if (section.has("correlation")) {
    section.refuse("correlation",
                   "is correlation_ms now, a time: over it the likeness of two delays falls to 1/e");
  }
  law.correlation_s = section.number("correlation_ms", 0.0, {0.0, 600'000.0}) * kMillisecond_s;
  law.shape = section.number("shape", 0.0, {0.0, 1000.0});
  for (const double p : section.numbers("table_p", kProbability)) law.table_p.push_back(p);
  for (const double ms : section.numbers("table_ms", kDelay_ms)) law.table_s.push_back(ms * kMillisecond_s);

  const bool has_jitter =
      law.distribution != DelayDistribution::kConstant && law.distribution != DelayDistribution::kTable;
  if (!has_jitter) {
    if (law.jitter_s > 0) {
      section.refuse_misplaced("jitter_ms", "distribution",
                               law.distribution == DelayDistribution::kTable
                                   ? "a table has its own jitter"
                                   : "jitter needs a distribution, such as \"normal\"");
    }
    law.jitter_s = 0.0;
  } else if (law.jitter_s == 0) {
    section.refuse("jitter_ms", "this distribution needs a jitter above 0");
  }
  if (law.distribution == DelayDistribution::kConstant) {
    if (law.correlation_s > 0) {
      section.refuse_misplaced("correlation_ms", "distribution", "a constant delay has nothing to correlate");
    }
    law.correlation_s = 0.0;
  }
  switch (law.distribution) {
    case DelayDistribution::kGamma:
      if (law.shape < 0.1) section.refuse("shape", "gamma needs a shape k of 0.1 or more");
      break;
    case DelayDistribution::kLognormal:
      if (law.shape < 0.01 || law.shape > 3) {
        section.refuse("shape", "lognormal needs a shape (sigma of the logarithm) within [0.01, 3]");
      }
      break;
    case DelayDistribution::kPareto:
      if (law.shape < 2.05) {
        section.refuse("shape",
                       "pareto needs a shape (tail index) of 2.05 or more, or its jitter would be infinite");
      }
      break;
    default:
      section.refuse_misplaced("shape", "distribution", "belongs to gamma, lognormal or pareto");
  }
  if (law.distribution == DelayDistribution::kTable) {
    const auto& p = law.table_p;
    if (p.size() < 2 || p.front() != 0 || p.back() != 1) section.refuse("table_p", "must run from 0 to 1");
    if (law.table_s.size() != p.size()) section.refuse("table_ms", "must be as long as table_p");
    for (std::size_t i = 1; i < p.size(); ++i) {
      if (p[i] <= p[i - 1]) section.refuse("table_p", "must ascend");
      if (law.table_s[i] < law.table_s[i - 1]) section.refuse("table_ms", "must not descend");
    }
  } else {
    for (const char* key : {"table_p", "table_ms"}) {
      section.refuse_misplaced(key, "distribution", "belongs to distribution = \"table\"");
    }
  }
  return law;
}

LossParameters read_loss(const Section& section) {
  LossParameters law;
  law.model = section.choice("loss_model", LossModel::kBernoulli, kLossModels);
  law.loss = section.number("loss", 0.0, kProbability);
  const double burst = section.number("loss_burst_packets", 0.0, {1.0, 1e6});
  const double burst_s = section.number("loss_burst_ms", 0.0, {0.01, 600'000.0}) * kMillisecond_s;
  law.ge_p = section.number("ge_p", 0.0, kProbability);
  law.ge_r = section.number("ge_r", 1.0, kProbability);
  law.ge_h = section.number("ge_h", 0.0, kProbability);
  law.ge_k = section.number("ge_k", 1.0, kProbability);
  law.p13 = section.number("p13", 0.0, kProbability);
  law.p31 = section.number("p31", 1.0, kProbability);
  law.p32 = section.number("p32", 0.0, kProbability);
  law.p23 = section.number("p23", 0.0, kProbability);
  law.p14 = section.number("p14", 0.0, kProbability);

  const auto refuse_unless = [&](bool belongs, std::initializer_list<const char*> keys,
                                 const char* complaint) {
    for (const char* key : keys) {
      if (!belongs) section.refuse_misplaced(key, "loss_model", complaint);
    }
  };
  const bool gilbert = law.model == LossModel::kGilbertElliott;
  const bool four = law.model == LossModel::kFourState;
  refuse_unless(gilbert || law.model == LossModel::kBernoulli, {"loss"},
                "belongs to loss_model = \"bernoulli\" or \"gilbert-elliott\"");
  refuse_unless(gilbert, {"loss_burst_packets", "loss_burst_ms", "ge_p", "ge_r", "ge_h", "ge_k"},
                "belongs to loss_model = \"gilbert-elliott\"");
  refuse_unless(four, {"p13", "p31", "p32", "p23", "p14"}, "belongs to loss_model = \"four-state\"");
  refuse_unless(law.model == LossModel::kTrace, {"loss_trace"}, "belongs to loss_model = \"trace\"");

  // By time, by packets or in the ge_ form, whichever stands in the most special table.
  const std::size_t time_rank = section.rank("loss_burst_ms");
  const std::size_t packets_rank = section.rank("loss_burst_packets");
  const std::size_t mean_rank = std::min({section.rank("loss"), time_rank, packets_rank});
  std::size_t ge_rank = section.rank("ge_p");
  const char* ge_key = "ge_p";
  for (const char* key : {"ge_r", "ge_h", "ge_k"}) {
    if (section.rank(key) < ge_rank) ge_key = key;
    ge_rank = std::min(ge_rank, section.rank(key));
  }
  if (gilbert && mean_rank == ge_rank && section.has(ge_key)) {
    section.refuse(ge_key, "either loss and a mean burst, or the ge_ probabilities");
  }
  if (gilbert && section.has("loss_burst_ms") && time_rank == packets_rank)
    section.refuse("loss_burst_packets", "either loss_burst_ms or loss_burst_packets");
  if (gilbert && mean_rank < ge_rank) {
    const bool in_time = time_rank < packets_rank;
    if (!section.has("loss") || (!in_time && !section.has("loss_burst_packets"))) {
      section.refuse(section.has("loss") ? "loss"
                     : in_time           ? "loss_burst_ms"
                                         : "loss_burst_packets",
                     "gilbert-elliott needs both loss and loss_burst_ms (or loss_burst_packets), or the ge_ "
                     "probabilities alone");
    }
    if (in_time) {
      law.burst_s = burst_s;
      if (law.loss == 1.0) section.refuse("loss", "a burst that never ends has no mean length");
      return law;
    }
    // Bad state: everything lost, left after `burst` packets on average; good state: nothing lost.
    law.ge_r = 1.0 / burst;
    law.ge_h = 0.0;
    law.ge_k = 1.0;
    if (law.loss * (1.0 + law.ge_r) > 1.0) section.refuse("loss", "is too much for bursts this short");
    law.ge_p = law.loss == 1.0 ? 1.0 : law.ge_r * law.loss / (1.0 - law.loss);
  } else if (gilbert) {
    if (!section.has("ge_p") || !section.has("ge_r")) {
      section.refuse("ge_p",
                     "gilbert-elliott needs loss and a mean burst, or ge_p and ge_r (and ge_h, ge_k)");
    }
    if (law.ge_p > 0 && law.ge_r == 0) section.refuse("ge_r", "must be above 0, or the bad state never ends");
  }
  if (four) {
    if (law.p13 + law.p14 > 1) section.refuse("p13", "p13 + p14 must not exceed 1");
    if (law.p31 + law.p32 > 1) section.refuse("p31", "p31 + p32 must not exceed 1");
    if (law.p13 > 0 && law.p31 == 0) section.refuse("p31", "must be above 0, or the burst never ends");
    if (law.p32 > 0 && law.p23 == 0) section.refuse("p23", "must be above 0, or the burst never goes on");
  }
  if (law.model == LossModel::kBernoulli && law.loss == 0) law.model = LossModel::kNone;
  return law;
}

}  // namespace

Conditions read_conditions(const Section& section) {
  Conditions now;
  now.delay = read_delay(section);
  now.loss = read_loss(section);
  now.order = section.choice("order", Order::kFifo, kOrders);
  now.reorder = section.number("reorder", 0.0, kProbability);
  now.reorder_gap = static_cast<int>(section.integer("reorder_gap", 1, {1.0, kMaxReorderGap}));
  now.tcp_like = section.boolean("tcp_like", false);
  now.rto_s = section.number("rto_ms", 200.0, {1.0, 60'000.0}) * kMillisecond_s;
  now.duplicate = section.number("duplicate", 0.0, kProbability);
  now.corrupt = section.number("corrupt", 0.0, kProbability);
  now.rate_bit_per_s = section.number_or_none("rate_kbit_per_s", {1.0, 1e9}) * 1e3;
  now.queue_bytes = section.integer("queue_bytes", 0, {64.0, 1e9});
  now.slots.period_s = section.number_or_none("slot_ms", {0.01, 10'000.0}) * kMillisecond_s;
  now.slots.jitter_s = section.number("slot_jitter_ms", 0.0, {0.0, 10'000.0}) * kMillisecond_s;
  now.slots.packets = section.integer("slot_packets", 0, {1.0, 1e6});
  now.slots.bytes = section.integer("slot_bytes", 0, {1500.0, 1e9});

  if (now.order == Order::kReorder) {
    if (now.reorder == 0) section.refuse("reorder", "order = \"reorder\" needs a probability above 0");
  } else {
    for (const char* key : {"reorder", "reorder_gap"}) {
      section.refuse_misplaced(key, "order", "belongs to order = \"reorder\"");
    }
  }
  if (now.tcp_like) {
    if (now.order != Order::kFifo)
      section.refuse("order", "a TCP-like link keeps the order; leave it at \"fifo\"");
    if (now.duplicate > 0) section.refuse("duplicate", "a TCP-like link delivers every packet once");
    if (now.corrupt > 0) section.refuse("corrupt", "a TCP-like link delivers every packet whole");
  } else {
    section.refuse_misplaced("rto_ms", "tcp_like", "belongs to tcp_like = true");
  }
  const bool recorded = section.has("rate_trace");
  if (recorded && section.has("rate_kbit_per_s"))
    section.refuse("rate_kbit_per_s", "rate_trace already says the rate");
  if ((now.rate_bit_per_s > 0 || recorded) && now.queue_bytes == 0)
    section.refuse("queue_bytes", "a rate needs a queue limit");
  if (now.rate_bit_per_s == 0 && !recorded) {
    section.refuse_misplaced("queue_bytes", "rate_kbit_per_s", "needs rate_kbit_per_s or rate_trace");
    now.queue_bytes = 0;
  }
  if (now.slots.period_s == 0) {
    for (const char* key : {"slot_jitter_ms", "slot_packets", "slot_bytes"}) {
      section.refuse_misplaced(key, "slot_ms", "needs slot_ms");
    }
    now.slots = {};
  } else {
    if (now.slots.jitter_s > now.slots.period_s) section.refuse("slot_jitter_ms", "must not exceed slot_ms");
    if (now.order != Order::kFifo) section.refuse("slot_ms", "slots keep the order; leave it at \"fifo\"");
  }
  return now;
}

}  // namespace telekerf::netem
