// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/tc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "netem/core/delay_distribution.h"
#include "netem/core/loss_chain.h"

namespace telekerf::netem {
namespace {

std::string per_cent(double probability) { return fmt::format("{:.6g}%", 100.0 * probability); }
std::string ms(double seconds) { return fmt::format("{:.6g}ms", 1e3 * seconds); }

std::string delay_words(const DelayParameters& law, TcExport& out) {
  if (law.distribution == DelayDistribution::kConstant)
    return law.delay_s > 0 ? " delay " + ms(law.delay_s) : "";
  const Moments moments = delay_moments(law);
  std::string words;
  switch (law.distribution) {
    case DelayDistribution::kUniform:  // tc's default law, plus or minus its half-width
      words = fmt::format(" delay {} {}", ms(law.delay_s), ms(std::numbers::sqrt3 * law.jitter_s));
      break;
    case DelayDistribution::kNormal:
      words = fmt::format(" delay {} {} distribution normal", ms(law.delay_s), ms(law.jitter_s));
      break;
    case DelayDistribution::kPareto:
      words = fmt::format(" delay {} {} distribution pareto", ms(moments.mean_s), ms(moments.sd_s));
      out.shortcomings.push_back(
          "pareto: tc's table is cut at 4 standard deviations and knows one tail index");
      break;
    default:
      words = fmt::format(" delay {} {} distribution normal", ms(moments.mean_s), ms(moments.sd_s));
      out.shortcomings.push_back(
          "distribution: tc ships no table for this law; the command takes a normal law of equal mean and "
          "deviation");
  }
  if (law.distribution == DelayDistribution::kUniform || law.distribution == DelayDistribution::kNormal ||
      law.distribution == DelayDistribution::kLaplace) {
    if (std::abs(moments.mean_s - law.delay_s) > 1e-3 * law.jitter_s) {
      out.shortcomings.push_back(
          "delays below zero: tc sends them at once, a heap at zero instead of a cut law");
    }
  }
  if (law.correlation_s > 0) {
    out.shortcomings.push_back(
        "correlation_ms: tc's has next to no effect on jitter and bends the law; left out");
  }
  return words;
}

std::string loss_words(const LossParameters& law, TcExport& out) {
  switch (law.model) {
    case LossModel::kNone:
      return "";
    case LossModel::kBernoulli:
      return " loss random " + per_cent(law.loss);
    case LossModel::kGilbertElliott:
      if (law.burst_s > 0) {
        out.shortcomings.push_back(fmt::format(
            "loss_burst_ms: tc counts packets; written for one every {:g} ms", 1e3 * kTcPacketInterval_s));
        const LossChain chain = loss_chain(law, kTcPacketInterval_s);
        return fmt::format(" loss gemodel {} {} 100% 0%", per_cent(chain.to[0][1]), per_cent(chain.to[1][0]));
      }
      return fmt::format(" loss gemodel {} {} {} {}", per_cent(law.ge_p), per_cent(law.ge_r),
                         per_cent(1 - law.ge_h), per_cent(1 - law.ge_k));
    case LossModel::kFourState:
      return fmt::format(" loss state {} {} {} {} {}", per_cent(law.p13), per_cent(law.p31),
                         per_cent(law.p32), per_cent(law.p23), per_cent(law.p14));
    case LossModel::kTrace:
      out.shortcomings.push_back("loss_trace: tc cannot replay losses");
      return "";
  }
  return "";
}

/// tc counts what waits in the queue and what merely waits for its delay.
std::int64_t limit_packets(const Conditions& now, std::int64_t packet_bytes) {
  constexpr std::int64_t kPlenty = 100'000;  // without a rate nothing waits; tc's own 1000 is too few
  if (now.rate_bit_per_s == 0) return kPlenty;
  const double under_way_bytes = now.rate_bit_per_s / 8.0 * delay_moments(now.delay).mean_s;
  const double bytes = static_cast<double>(now.queue_bytes) + under_way_bytes;
  return std::max<std::int64_t>(1, std::llround(bytes / static_cast<double>(packet_bytes)));
}

}  // namespace

TcExport export_to_tc(const DirectionProfile& profile, const std::string& device, std::int64_t packet_bytes) {
  TcExport out;
  if (profile.recording && !profile.loss_only) {
    out.shortcomings.push_back("trace: tc cannot replay a recording; nothing is left of this profile");
    out.command = fmt::format("tc qdisc replace dev {} root netem", device);
    return out;
  }
  const Conditions& now = profile.stages.front().conditions;
  std::string words =
      fmt::format("tc qdisc replace dev {} root netem limit {}", device, limit_packets(now, packet_bytes));
  words += delay_words(now.delay, out);
  if (now.order == Order::kReorder) {
    words += " reorder " + per_cent(now.reorder);
    out.shortcomings.push_back(
        "reorder: tc sends the chosen packets without any delay, past everything under way; reorder_gap has "
        "no "
        "counterpart (tc's gap spaces the chosen packets)");
    if (now.delay.distribution == DelayDistribution::kConstant && now.delay.delay_s == 0)
      words += " delay 1ms";
  } else if (now.order == Order::kFifo && now.delay.distribution != DelayDistribution::kConstant) {
    out.shortcomings.push_back("order = fifo: tc lets jitter reorder packets");
  }
  if (now.tcp_like) {
    if (now.loss.model != LossModel::kNone) {
      out.shortcomings.push_back("tcp_like: tc cannot turn a loss into a wait; losses left out");
    }
  } else {
    words += loss_words(now.loss, out);
  }
  if (now.duplicate > 0) {
    words += " duplicate " + per_cent(now.duplicate);
    if (now.delay.distribution != DelayDistribution::kConstant) {
      out.shortcomings.push_back(
          "duplicate: tc draws another delay for the copy instead of sending it right behind");
    }
  }
  if (now.corrupt > 0) words += " corrupt " + per_cent(now.corrupt);
  if (now.rate_bit_per_s > 0) {
    words += fmt::format(" rate {:.6g}kbit", now.rate_bit_per_s / 1e3);
    out.shortcomings.push_back(fmt::format(
        "queue_bytes: tc's limit counts packets, those under way included; written for packets of "
        "{} bytes (--packet-bytes)",
        packet_bytes));
  }
  if (profile.rate_trace) out.shortcomings.push_back("rate_trace: tc cannot replay a rate; left out");
  if (now.slots.period_s > 0) {
    words += fmt::format(" slot {} {}", ms(now.slots.period_s), ms(now.slots.period_s + now.slots.jitter_s));
    if (now.slots.packets > 0) words += fmt::format(" packets {}", now.slots.packets);
    if (now.slots.bytes > 0) words += fmt::format(" bytes {}", now.slots.bytes);
    if (now.slots.jitter_s > 0)
      out.shortcomings.push_back("slot_jitter_ms: tc lets slots drift instead of keeping a period");
  }
  if (profile.stages.size() > 1)
    out.shortcomings.push_back("stage: tc knows no time; only the beginning is here");
  if (!profile.events.empty()) out.shortcomings.push_back("event: tc knows no time; events are left out");
  const bool random = now.delay.distribution != DelayDistribution::kConstant ||
                      now.loss.model != LossModel::kNone || now.duplicate > 0 || now.corrupt > 0 ||
                      now.order == Order::kReorder;
  if (random)
    out.shortcomings.push_back(
        "seed: tc draws other random numbers every time (a seed only since Linux 6.6)");
  out.command = words;
  return out;
}

}  // namespace telekerf::netem
