// SPDX-License-Identifier: Apache-2.0
#include "netem/core/loss_chain.h"

#include "netem/core/decay.h"

namespace telekerf::netem {

double burst_memory_s(const LossParameters& law) { return law.burst_s * (1.0 - law.loss); }

LossChain loss_chain(const LossParameters& law, double interval_s) {
  LossChain chain;
  chain.to[0][0] = 1.0;
  chain.stationary[0] = 1.0;
  switch (law.model) {
    case LossModel::kNone:
    case LossModel::kTrace:
      break;
    case LossModel::kBernoulli:
      chain.lost[0] = law.loss;
      break;
    case LossModel::kGilbertElliott: {
      chain.states = 2;  // good, bad
      if (law.burst_s > 0) {
        const double left = decay(interval_s, burst_memory_s(law));
        chain.to[0] = {1.0 - law.loss * (1.0 - left), law.loss * (1.0 - left)};
        chain.to[1] = {(1.0 - law.loss) * (1.0 - left), law.loss + (1.0 - law.loss) * left};
        chain.lost = {0.0, 1.0};
        chain.stationary = {1.0 - law.loss, law.loss};
        break;
      }
      chain.to[0] = {1.0 - law.ge_p, law.ge_p};
      chain.to[1] = {law.ge_r, 1.0 - law.ge_r};
      chain.lost = {1.0 - law.ge_k, 1.0 - law.ge_h};
      const double bad = law.ge_p > 0 ? law.ge_p / (law.ge_p + law.ge_r) : 0.0;
      chain.stationary = {1.0 - bad, bad};
      break;
    }
    case LossModel::kFourState: {
      chain.states = 4;
      chain.to[0] = {1.0 - law.p13 - law.p14, 0.0, law.p13, law.p14};
      chain.to[1] = {0.0, 1.0 - law.p23, law.p23, 0.0};
      chain.to[2] = {law.p31, law.p32, 1.0 - law.p31 - law.p32, 0.0};
      chain.to[3] = {1.0, 0.0, 0.0, 0.0};
      chain.lost = {0.0, 0.0, 1.0, 1.0};
      // The graph 2 - 3 - 1 - 4 is a tree: what flows over an edge flows back over it.
      const double burst = law.p13 > 0 ? law.p13 / law.p31 : 0.0;
      const double pause = burst > 0 && law.p32 > 0 ? burst * law.p32 / law.p23 : 0.0;
      const double sum = 1.0 + burst + pause + law.p14;
      chain.stationary = {1.0 / sum, pause / sum, burst / sum, law.p14 / sum};
      break;
    }
  }
  return chain;
}

double mean_loss(const LossChain& chain) {
  double loss = 0.0;
  for (int i = 0; i < chain.states; ++i) loss += chain.stationary[i] * chain.lost[i];
  return loss;
}

double mean_burst(const LossChain& chain) {
  double begins = 0.0;
  for (int i = 0; i < chain.states; ++i) {
    for (int j = 0; j < chain.states; ++j) {
      begins += chain.stationary[i] * (1.0 - chain.lost[i]) * chain.to[i][j] * chain.lost[j];
    }
  }
  return begins > 0 ? mean_loss(chain) / begins : 0.0;
}

}  // namespace telekerf::netem
