// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/loss_checks.h"

#include <algorithm>
#include <cmath>

namespace telekerf::netem {
namespace {

void check_burst(const LossParameters& law, const LossChain& chain, std::uint64_t lost, std::uint64_t bursts,
                 double n, Checks& checks) {
  const double nominal = mean_burst(chain);
  const auto count = static_cast<double>(bursts);
  const double measured = static_cast<double>(lost) / count;
  const bool renewal =
      law.model == LossModel::kBernoulli ||
      (law.model == LossModel::kGilbertElliott && (law.burst_s > 0 || (law.ge_h == 0 && law.ge_k == 1)));
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

}  // namespace

void check_loss(const Conditions& nominal, const Run& run, double rate_hz, bool event_losses,
                Checks& checks) {
  const LossChain chain = loss_chain(nominal.loss, 1.0 / rate_hz);
  const double p = mean_loss(chain);
  const auto n = static_cast<double>(run.sent.size());
  std::uint64_t lost = 0;
  std::uint64_t bursts = 0;
  bool before = false;
  for (const Sent& sent : run.sent) {
    const bool now = sent.outcome.lost_by_model || sent.outcome.retransmissions > 0;
    lost += now;
    bursts += now && !before;
    before = now;
  }
  if (nominal.tcp_like) {
    checks.none("lost on a TCP-like link", run.counters.lost);
    if (!event_losses) checks.fraction("retransmitted", lost, run.sent.size(), p, chain_memory(chain));
    return;
  }
  if (p == 0) {
    checks.none("lost by the model", lost);
    return;
  }
  checks.fraction("loss", lost, run.sent.size(), p, chain_memory(chain));
  if (bursts > 0 && p < 1) check_burst(nominal.loss, chain, lost, bursts, n, checks);
}

}  // namespace telekerf::netem
