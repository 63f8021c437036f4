// SPDX-License-Identifier: Apache-2.0
// Every loss law is a small Markov chain that takes one step a packet and loses it with its state's
// probability.
#pragma once

#include <array>

#include "netem/core/profile.h"

namespace telekerf::netem {

inline constexpr int kMaxLossStates = 4;

struct LossChain {
  int states = 1;
  std::array<std::array<double, kMaxLossStates>, kMaxLossStates> to{};  ///< to[i][j]: from i to j
  std::array<double, kMaxLossStates> lost{};                            ///< loss probability in a state
  std::array<double, kMaxLossStates> stationary{};                      ///< stationary distribution
};

/// Of packets `interval_s` apart, which only laws in time ask for; kNone and kTrace give a chain that loses
/// nothing.
LossChain loss_chain(const LossParameters& law, double interval_s = 0.0);

/// Gilbert-Elliott in time: what is left of the state decays with this time constant, s.
double burst_memory_s(const LossParameters& law);

double mean_loss(const LossChain& chain);

/// Mean length of a run of lost packets: P(lost) / P(lost after a delivered one); 0 without losses.
double mean_burst(const LossChain& chain);

}  // namespace telekerf::netem
