// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_rivals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace telekerf::experiments {
namespace {

using master::EstimatorSettings;
using slave::BareAccelerations;

constexpr master::MakeEstimator kPredictor = &master::make_predictor;
constexpr auto kInnovation = &master::make_estimator<master::DelayedInnovation<master::OpenIntegrator>>;
constexpr auto kThesis = &master::make_estimator<master::CommunicationDisturbanceObserver>;
constexpr auto kConvergent =
    &master::make_estimator<master::DelayedInnovation<master::CommunicationDisturbanceObserver>>;
constexpr auto kWindow = &master::make_estimator<master::CommandWindow>;
constexpr auto kNone = &master::make_estimator<master::NoPrediction>;

constexpr Rival kRivals[] = {
    {Law::kAnchored, kPredictor},
    {Law::kLocal, kPredictor},
    {Law::kLocal, kNone},
    {Law::kRemoteAcceleration, kPredictor, BareAccelerations::kIntegrated},
    {Law::kRemoteAcceleration, kWindow, BareAccelerations::kIntegrated},
    {Law::kRemoteAcceleration, kPredictor},
    {Law::kRemoteAcceleration, kWindow},
    {Law::kRemoteAcceleration, kConvergent},
    {Law::kRemoteAcceleration, kThesis},
    {Law::kRemoteAcceleration, kInnovation},
    {Law::kRemoteAcceleration, kNone},
    {Law::kAnchored, kInnovation},
    {Law::kAnchored, kThesis},
    {Law::kAnchored, kNone},
};
constexpr Rival kProfileRivals[] = {kRivals[0], kRivals[3], kRivals[5], kRivals[6]};

/// A loop that spans the delay begins slowly enough for the timing that it is assumed to bear.
constexpr double kTimingError_s = 1e-4;

/// A run that is not stable counts as one with this error: as few seeds as can be.
constexpr double kUnstable_um = 1e6;

struct Range {
  const char* name;
  double least, most;
  double (*get)(const master::StationSettings& settings);
  void (*set)(master::StationSettings& settings, double value);
  bool whole = false;
};
constexpr Range kLaw{"tracking_rad_s", 0.1, 400.0,
                     [](const master::StationSettings& s) { return s.tracking_rad_s; },
                     [](master::StationSettings& s, double value) { s.tracking_rad_s = value; }};
constexpr Range kCopies{
    "redundancy",
    1,
    7,
    [](const master::StationSettings& s) { return static_cast<double>(s.node.command.codec.redundancy); },
    [](master::StationSettings& s, double value) {
      s.node.command.codec.redundancy = static_cast<int>(value);
    },
    true};

/// A gain of the estimator.
template <double EstimatorSettings::*kMember>
constexpr Range gain(const char* name, double least, double most) {
  return {name, least, most,
          [](const master::StationSettings& s) { return s.node.command.observer.*kMember; },
          [](master::StationSettings& s, double value) { s.node.command.observer.*kMember = value; }};
}
constexpr Range kCutoff = gain<&EstimatorSettings::thesis_cutoff_rad_s>("thesis_cutoff_rad_s", 0.5, 1000.0);
constexpr Range kGain = gain<&EstimatorSettings::innovation_gain_per_s>("innovation_gain_per_s", 0.01, 100.0);
constexpr Range kPoles = gain<&EstimatorSettings::predictor_rad_s>("predictor_rad_s", 0.5, 400.0);
constexpr Range kDisturbance = gain<&EstimatorSettings::disturbance_rad_s>("disturbance_rad_s", 0.01, 100.0);

std::vector<Range> ranges_of(const DelayTrial& trial) {
  const master::CommandStreamSettings& command = trial.master.node.command;
  const master::MakeEstimator estimator = command.observer.estimator;
  const bool shipped = command.law == Law::kAnchored && estimator == kPredictor;
  if (shipped || command.law == Law::kLocal) return {};
  if (estimator == kThesis) return {kLaw, kCopies, kCutoff};
  if (estimator == kConvergent) return {kLaw, kCopies, kCutoff, kGain};
  if (estimator == kInnovation) return {kLaw, kCopies, kGain};
  if (estimator == kPredictor) return {kLaw, kCopies, kPoles, kDisturbance};
  return {kLaw, kCopies};
}

double two_digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::round(value / unit) * unit;
}

/// Mean tracking error over the seeds, um; nullopt as soon as it is not below `least_um`.
std::optional<double> cost(const HandRecord& hand, DelayTrial trial, double least_um) {
  double sum_um = 0.0;
  for (int i = 0; i < kTunedSeeds; ++i, ++trial.seed) {
    const DelayResult result = run_trial(hand, trial);
    sum_um += (result.stable ? result.tracking_rmse_um : kUnstable_um) / kTunedSeeds;
    if (!(sum_um < least_um)) return std::nullopt;
  }
  return sum_um;
}

}  // namespace

std::span<const Rival> rivals() { return kRivals; }
std::span<const Rival> profile_rivals() { return kProfileRivals; }

std::string word_of(Law law) { return std::string(master::kLaws.word(law)); }
std::string word_of(master::MakeEstimator estimator) {
  return std::string(master::kEstimators.word(estimator));
}
std::string law_of(const Rival& rival) {
  if (rival.law != Law::kRemoteAcceleration || rival.bare == BareAccelerations::kObeyed)
    return word_of(rival.law);
  return word_of(rival.law) + ", " + std::string(slave::kBareAccelerations.word(rival.bare));
}
bool same(const Rival& a, const Rival& b) {
  return a.law == b.law && a.estimator == b.estimator && a.bare == b.bare;
}

DelayTrial trial_of(const Rival& rival, const netem::Profile& network, std::uint64_t seed) {
  DelayTrial trial;
  trial.master.node.command.law = rival.law;
  trial.master.node.command.observer.estimator = rival.estimator;
  trial.slave.node.bare_accelerations = rival.bare;
  trial.network = network;
  trial.seed = seed;
  return trial;
}

std::vector<Tuned> tuning_of(const DelayTrial& trial) {
  std::vector<Tuned> tuning;
  for (const Range& range : ranges_of(trial)) tuning.push_back({range.name, range.get(trial.master)});
  return tuning;
}

DelayTrial with_tuning(DelayTrial trial, std::span<const Tuned> tuning) {
  if (tuning.empty()) return trial;
  trial.master.node.command.timing_error_s = kTimingError_s;
  const std::vector<Range> ranges = ranges_of(trial);
  for (const Tuned& tuned : tuning) {
    const auto range =
        std::find_if(ranges.begin(), ranges.end(), [&](const Range& r) { return r.name == tuned.name; });
    range->set(trial.master, tuned.value);
  }
  return trial;
}

std::vector<Tuned> best_tuning(const HandRecord& hand, const DelayTrial& trial, double rtt_s) {
  std::vector<Tuned> best = tuning_of(trial);
  if (best.empty()) return best;
  const std::vector<Range> ranges = ranges_of(trial);
  const double delay_s = rtt_s + 0.05;  // filling a block and the play-out come on top
  for (Tuned& tuned : best) {
    if (tuned.name == kLaw.name) tuned.value = two_digits(std::min(60.0, 3.0 / delay_s));
    if (tuned.name == kGain.name) tuned.value = two_digits(1.0 / (std::numbers::e * delay_s));
  }
  double least_um = 2.0 * kUnstable_um;
  std::vector<Tuned> next = best;
  const auto better_next = [&] {
    const std::optional<double> um = cost(hand, with_tuning(trial, next), 0.99 * least_um);
    if (um) best = next, least_um = *um;
    return um.has_value();
  };
  // The law's bandwidth first, over two decades: the best of them is where to begin.
  const double guess = best[0].value;
  for (const double factor : {1.0, 0.5, 2.0, 0.25, 4.0, 0.125, 8.0, 0.06, 0.03}) {
    next[0].value = std::clamp(two_digits(factor * guess), kLaw.least, kLaw.most);
    better_next();
  }
  for (const double step : {2.0, 1.4}) {
    bool better = true;
    while (better) {
      better = false;
      for (std::size_t i = 0; i < best.size(); ++i) {
        for (const double factor : {step, 1.0 / step}) {
          while (true) {
            next = best;
            const double value = best[i].value * factor;
            next[i].value = std::clamp(ranges[i].whole ? std::round(value) : two_digits(value),
                                       ranges[i].least, ranges[i].most);
            if (next[i].value == best[i].value) break;
            if (!better_next()) break;
            better = true;
          }
        }
      }
    }
  }
  return best;
}

}  // namespace telekerf::experiments
