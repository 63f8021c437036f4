// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_runs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "experiments/parallel.h"

namespace telekerf::experiments {
namespace {

using Said = std::function<void(std::size_t, std::size_t)>;

constexpr std::array<double, 3> kLoss{0.0, 0.01, 0.05};
/// Jitter of the networks that rivals are tuned on, of the round trip.
constexpr double kTunedShare = 0.1;
/// And their losses: those of the tables.
constexpr double tuned_loss(double rtt_ms) { return rtt_ms > 200.0 ? 0.05 : 0.01; }
constexpr std::array kProfiles{
    "ideal", "lan",           "5g",     "4g",        "wifi",    "wifi-quiet",      "wifi-lossy", "leo",
    "geo",   "transatlantic", "sydney", "lindbergh", "hostile", "thesis-constant", "thesis-tcp"};

Run make_run(const Rival& rival, double rtt_ms, double jitter_ms, double loss, std::uint64_t seed) {
  Run run;
  run.rival = rival;
  run.trial = trial_of(rival, netem::simple_profile(rtt_ms * 1e-3, jitter_ms * 1e-3, loss), seed);
  run.rtt_ms = rtt_ms;
  run.jitter_ms = jitter_ms;
  run.loss = loss;
  return run;
}

Run make_run(const Rival& rival, const std::string& profile, std::uint64_t seed) {
  Run run;
  run.rival = rival;
  run.profile = profile;
  run.trial = trial_of(rival, netem::load_profile(profile), seed);
  return run;
}

/// The forward way grows by `more_s` in the middle of the run.
void step_delay(netem::DirectionProfile& direction, double at_s, double more_s) {
  netem::Stage later = direction.stages.back();
  later.from_s = at_s;
  later.conditions.delay.delay_s += more_s;
  direction.stages.push_back(later);
}

/// Over round trip, jitter, loss and codec.
void add_grid(const Rival& rival, std::uint64_t seed, std::vector<Run>& runs) {
  for (const double rtt_ms : kRttMs) {
    for (const double share : {0.0, kTunedShare}) {
      if (rtt_ms == 0.0 && share > 0.0) continue;  // no jitter without delay
      for (const double loss : kLoss) {
        for (const codec::CodecChoice& codec : {codec::kDefaultCodec, *codec::kCodecs.find("raw")}) {
          runs.push_back(make_run(rival, rtt_ms, share * rtt_ms, loss, seed));
          runs.back().codec = runs.back().trial.master.codec = codec;
        }
      }
    }
  }
}

/// What else can go wrong, at 100 ms.
void add_conditions(const Rival& rival, std::uint64_t seed, double duration_s, std::vector<Run>& runs) {
  for (const char* condition : {"wrong-start", "push-1-n", "delay-step-50-ms"}) {
    runs.push_back(make_run(rival, 100.0, 0.0, 0.0, seed));
    runs.back().condition = condition;
  }
  Run* const three = &runs[runs.size() - 3];
  three[0].trial.wrong_start = true;
  three[1].trial.push_n = 1.0;
  step_delay(three[2].trial.network.forward, 0.5 * duration_s, 0.05);
}

double rtt_s(const netem::Profile& profile) {
  return profile.forward.stages.front().conditions.delay.delay_s +
         profile.backward.stages.front().conditions.delay.delay_s;
}

struct Tuning {
  Rival rival;
  double rtt_ms = 0.0;
  std::string profile;
  std::vector<Tuned> tuned;
};

/// Each rival for each round trip, and for each profile where it is run on it.
std::vector<Tuning> tune(const HandRecord& hand, const std::vector<double>& only_rtt_ms, std::uint64_t seed,
                         const Said& said) {
  std::vector<Tuning> all;
  const std::vector<double> every(kRttMs.begin(), kRttMs.end());
  for (const Rival& rival : rivals()) {
    for (const double rtt_ms : only_rtt_ms.empty() ? every : only_rtt_ms)
      all.push_back({rival, rtt_ms, "", {}});
  }
  for (const Rival& rival : profile_rivals()) {
    for (const char* profile : kProfiles)
      if (only_rtt_ms.empty()) all.push_back({rival, 0.0, profile, {}});
  }
  std::atomic<std::size_t> done{0};
  for_each_parallel(all.size(), [&](std::size_t i) {
    Tuning& t = all[i];
    const Run run = t.profile.empty()
                        ? make_run(t.rival, t.rtt_ms, kTunedShare * t.rtt_ms, tuned_loss(t.rtt_ms), seed)
                        : make_run(t.rival, t.profile, seed);
    t.tuned = best_tuning(hand, run.trial, rtt_s(run.trial.network));
    if (++done % 20 == 0) said(done, all.size());
  });
  return all;
}

void take_tuning(const std::vector<Tuning>& all, Run& run) {
  for (const Tuning& t : all) {
    if (!same(t.rival, run.rival) || t.profile != run.profile) continue;
    if (t.profile.empty() && t.rtt_ms != run.rtt_ms) continue;
    run.tuning = t.tuned;
    run.trial = with_tuning(run.trial, t.tuned);
  }
}

}  // namespace

std::vector<Run> full_benchmark(const Length& length, std::uint64_t seed, const Said& said) {
  const HandRecord short_hand = record_hand("heart", length.grid_s, seed);
  const std::vector<Tuning> tunings = tune(short_hand, length.only_rtt_ms, seed, said);

  const bool all = length.only_rtt_ms.empty();
  std::vector<Run> runs;
  for (const Rival& rival : rivals()) {
    for (const double rtt_ms : length.only_rtt_ms)
      runs.push_back(make_run(rival, rtt_ms, kTunedShare * rtt_ms, tuned_loss(rtt_ms), seed));
    if (!all) continue;
    add_grid(rival, seed, runs);
    add_conditions(rival, seed, length.grid_s, runs);
  }
  const std::size_t of_grid = runs.size();
  std::vector<HandRecord> hands;
  for (int i = 0; all && i < length.profile_seeds; ++i) {
    const std::uint64_t its_seed = seed + static_cast<std::uint64_t>(i);
    hands.push_back(record_hand("heart", length.profile_s, its_seed));
    for (const Rival& rival : profile_rivals()) {
      for (const char* profile : kProfiles) runs.push_back(make_run(rival, profile, its_seed));
    }
  }
  const std::size_t a_seed = profile_rivals().size() * kProfiles.size();
  std::atomic<std::size_t> done{0};
  for_each_parallel(runs.size(), [&](std::size_t i) {
    Run& run = runs[i];
    const bool on_profile = i >= of_grid;
    run.duration_s = on_profile ? length.profile_s : length.grid_s;
    take_tuning(tunings, run);
    run.result = run_trial(on_profile ? hands[(i - of_grid) / a_seed] : short_hand, run.trial);
    run.result.error_m.clear();
    run.result.prediction_error_m.clear();
    if (++done % 200 == 0) said(done, runs.size());
  });
  return runs;
}

nlohmann::ordered_json row_of(const Run& run) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
  };
  const auto word = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
  };
  const bool named = !run.profile.empty();
  const DelayResult& r = run.result;
  nlohmann::ordered_json row;
  row["law"] = word_of(run.rival.law);
  row["bare_accelerations"] = slave::kBareAccelerations.word(run.rival.bare);
  row["estimator"] = word_of(run.rival.estimator);
  row["codec"] = codec::kCodecs.word(run.codec);
  row["tuning"] = nlohmann::ordered_json::object();
  for (const Tuned& tuned : run.tuning) row["tuning"][tuned.name] = tuned.value;
  row["rtt_ms"] = named ? nlohmann::ordered_json() : number(run.rtt_ms);
  row["jitter_ms"] = named ? nlohmann::ordered_json() : number(run.jitter_ms);
  row["loss"] = named ? nlohmann::ordered_json() : number(run.loss);
  row["profile"] = word(run.profile);
  row["condition"] = word(run.condition);
  row["seed"] = run.trial.seed;
  row["duration_s"] = run.duration_s;
  row["tracking_rmse_um"] = number(r.tracking_rmse_um);
  row["tracking_max_um"] = number(r.tracking_max_um);
  row["prediction_rmse_um"] = number(r.prediction_rmse_um);
  row["prediction_max_um"] = number(r.prediction_max_um);
  row["counted_ticks"] = r.counted;
  row["settle_s"] = number(r.settle_s);
  row["stable"] = r.stable;
  row["wire_bytes_per_s"] = number(r.wire_bytes_per_s);
  row["total_ms"] = number(r.total_ms);
  return row;
}

const Run* find_run(const std::vector<Run>& runs, const Rival& rival, double rtt_ms, double jitter_share,
                    double loss) {
  const auto found = std::find_if(runs.begin(), runs.end(), [&](const Run& run) {
    return same(run.rival, rival) && run.codec == codec::kDefaultCodec && run.profile.empty() &&
           run.condition.empty() && run.rtt_ms == rtt_ms && run.loss == loss &&
           std::abs(run.jitter_ms - jitter_share * rtt_ms) < 1e-9;
  });
  return found == runs.end() ? nullptr : &*found;
}

}  // namespace telekerf::experiments
