// SPDX-License-Identifier: Apache-2.0
// Delay laws by inversion: a standard normal number z goes through the law's quantile function, z ->
// Q(Phi(z)). Correlated normals therefore give correlated delays whose marginal law is exact (Gaussian
// copula).
#pragma once

#include "netem/core/profile.h"

namespace telekerf::netem {

/// P(Z > z) of a standard normal number, and for tails of up to 1/2 its inverse.
double normal_tail(double z);
double normal_above(double tail);

/// The delay that the fraction `lower` of all packets stays below (nominal law, cut at zero included);
/// `upper` = 1 - lower is given as well because a far tail cannot be told from 1 otherwise. Seconds.
double delay_quantile(const DelayParameters& law, double lower, double upper);

/// The same over the standard normal: delay_quantile(Phi(z), 1 - Phi(z)).
double delay_at_normal(const DelayParameters& law, double z);

/// Correlation of the normal scores behind two delays that are `interval_s` apart.
double correlation_over(const DelayParameters& law, double interval_s);

struct Moments {
  double mean_s = 0.0;
  double sd_s = 0.0;
  double fourth_s4 = 0.0;  ///< fourth central moment
};
/// Of the nominal law, between its quantiles at normal scores -z_limit and z_limit (values outside count as
/// the limits themselves: winsorised).
Moments delay_moments(const DelayParameters& law, double z_limit = 8.0);

}  // namespace telekerf::netem
