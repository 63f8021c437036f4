// SPDX-License-Identifier: Apache-2.0
// Confidence bounds for averages over packets that depend on one another.
#pragma once

#include "netem/core/delay_distribution.h"
#include "netem/core/loss_chain.h"

namespace telekerf::netem {

inline constexpr double kNs = 1e-9;  ///< a nanosecond in seconds

/// log(2 / false-alarm probability of one check): a verification makes fewer than 100 checks and shall raise
/// one false alarm in 10^6.
inline constexpr double kLogAlarm = 19.1;

/// Half-width of the bounds of an average of `n` values with variance `variance`, at most `range` away from
/// their mean, that are functions of a Markov chain whose second-largest eigenvalue is `memory` (0:
/// independent). Bernstein's inequality, in the form of Jiang, Sun and Fan (2018) for chains: no normality
/// and no large n assumed.
double bernstein(double n, double variance, double range, double memory);

/// Second-largest eigenvalue of the chain's transition matrix (its graph is a tree, so they are all real); >=
/// 0.
double chain_memory(const LossChain& chain);

/// Asymptotic variance of sqrt(n) x average of (lost - burst x begins), where `begins` marks a lost packet
/// after a delivered one: what decides how well the mean burst length can be told.
double burst_variance(const LossChain& chain);

/// Probability that packets sent `interval_s` apart in free order overtake their direct predecessor.
double overtaking_probability(const DelayParameters& law, double interval_s);

}  // namespace telekerf::netem
