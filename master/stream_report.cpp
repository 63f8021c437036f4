// SPDX-License-Identifier: Apache-2.0
#include "master/stream_report.h"

#include "common/protocol/overhead.h"
#include "master/law.h"
#include "master/observer/estimators.h"

namespace telekerf::master {

void report_stream(const StationSettings& settings, const MasterNode& node, RunRecord& record) {
  const streaming::LinkStatistics& link = node.link();
  const auto& command = settings.node.command.codec;
  const double run_s = static_cast<double>(node.tick()) * (1.0 / settings.node.control_hz);
  const auto packets = static_cast<double>(link.packets());
  Metrics& f = record.master_figures;
  f["beta"] = settings.beta;
  f["seed"] = static_cast<double>(settings.seed);
  f["rate_hz"] = settings.node.control_hz;
  if (link.round_trips() > 0) {  // otherwise nobody knows
    f["rtt_p50_ms"] = link.rtt_quantile_ms(0.50);
    f["rtt_p95_ms"] = link.rtt_quantile_ms(0.95);
    f["rtt_p99_ms"] = link.rtt_quantile_ms(0.99);
  }
  f["clocks_wrong"] = static_cast<double>(link.clocks_wrong());
  f["lost"] = static_cast<double>(node.states().lost);
  f["block"] = command.block;
  f["keep"] = command.keep;
  f["max_rms"] = command.max_rms;
  f["redundancy"] = command.redundancy;
  f["copies_mean"] = link.mean_copies();
  f["copies_max"] = link.max_copies();
  f["block_ms"] = (command.block - 1) * 1e-6 * command.sample_period_ns;
  f["packets_per_s"] = run_s > 0.0 ? packets / run_s : 0.0;
  f["wire_bytes_per_s"] = run_s > 0.0 ? static_cast<double>(link.wire_bytes()) / run_s : 0.0;
  f["payload_bytes_per_s"] = run_s > 0.0 ? static_cast<double>(link.payload_bytes()) / run_s : 0.0;
  // All coded bytes, redundant copies and block heads included, over the axis samples they newly carry.
  f["bits_per_sample"] =
      packets > 0.0 ? 8.0 * static_cast<double>(link.payload_bytes()) / (packets * 3.0 * command.block) : 0.0;
  if (node.felt().on()) add_figures(node.felt().statistics(), f);
  const streaming::ClockEstimate clocks = link.clocks();
  f["clock_offset_us"] = clocks.offset_s * 1e6;
  f["clock_skew_ppm"] = clocks.skew * 1e6;
  f["clock_uncertainty_us"] = clocks.uncertainty_s * 1e6;
  f["observer_delay_ms"] = node.observed().delay_s * 1e3;
  record.words["law"] = kLaws.word(settings.node.command.law);
  record.words["estimator"] = kEstimators.word(settings.node.command.observer.estimator);
  record.words["codec"] = codec::kCodecs.word(settings.codec);
}

}  // namespace telekerf::master
