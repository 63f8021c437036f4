// SPDX-License-Identifier: Apache-2.0
// Who is held against whom: laws, estimators and what the slave makes of their commands, each with the tuning
// that suits its condition best.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/delay/delay_trial.h"

namespace telekerf::experiments {

struct Rival {
  Law law = Law::kAnchored;
  master::MakeEstimator estimator = &master::make_predictor;
  slave::BareAccelerations bare = slave::BareAccelerations::kObeyed;
};

/// The default first.
std::span<const Rival> rivals();
/// Those whose rows over the shipped profiles are printed.
std::span<const Rival> profile_rivals();

std::string word_of(Law law);
std::string word_of(master::MakeEstimator estimator);
/// "remote-acceleration, integrated" where the slave does not simply obey.
std::string law_of(const Rival& rival);
bool same(const Rival& a, const Rival& b);

/// The rival's trial on `network` with the settings that it comes with.
DelayTrial trial_of(const Rival& rival, const netem::Profile& network, std::uint64_t seed);

/// One setting of a rival's tuning, by its name on the command line.
struct Tuned {
  std::string name;
  double value = 0.0;
};

/// What a rival can be tuned by, with the values of `trial`: the law's bandwidth, the estimator's gains.
/// Empty for the default and for law local, which are taken as they are shipped.
std::vector<Tuned> tuning_of(const DelayTrial& trial);
/// `trial` with those values.
DelayTrial with_tuning(DelayTrial trial, std::span<const Tuned> tuning);

/// Of a tuning's search: it is to hold for the network, not for one seed of it.
inline constexpr int kTunedSeeds = 3;

/// The tuning that is stable in most of kTunedSeeds of the network (the trial's seed and those after it), of
/// those the one with the least mean tracking error; found by pattern search: each value in turn times or
/// over 2, then 1.4, while that helps; two digits.
std::vector<Tuned> best_tuning(const HandRecord& hand, const DelayTrial& trial, double rtt_s);

}  // namespace telekerf::experiments
