// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment delay: every law and estimator across every delay; docs/results/delay.md explains the
// rows.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/delay/delay_ideal.h"
#include "experiments/delay/delay_trial.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;
using reporting::Panel;

constexpr std::array<double, 7> kRttMs{0, 20, 50, 100, 200, 400, 800};
/// Of the figure's axis; what runs away is drawn at its upper end.
constexpr double kLeast_um = 0.1;
constexpr double kMost_um = 1e5;
constexpr std::array<double, 3> kLoss{0.0, 0.01, 0.05};
constexpr std::array kProfiles{
    "ideal", "lan",           "5g",     "4g",        "wifi",    "wifi-lossy",      "leo",
    "geo",   "transatlantic", "sydney", "lindbergh", "hostile", "thesis-constant", "thesis-tcp"};

struct Pair {
  Law law;
  master::MakeEstimator estimator;
};
constexpr master::MakeEstimator kPredictor = &master::make_predictor;
constexpr master::MakeEstimator kInnovation = &master::make_estimator<master::DelayedInnovation>;
constexpr master::MakeEstimator kThesis = &master::make_estimator<master::CommunicationDisturbanceObserver>;
constexpr master::MakeEstimator kNone = &master::make_estimator<master::NoPrediction>;

std::string word_of(Law law) { return std::string(master::kLaws.word(law)); }
std::string word_of(master::MakeEstimator estimator) {
  return std::string(master::kEstimators.word(estimator));
}
constexpr std::array<Pair, 10> kPairs{{{Law::kAnchored, kPredictor},
                                       {Law::kAnchored, kInnovation},
                                       {Law::kAnchored, kThesis},
                                       {Law::kAnchored, kNone},
                                       {Law::kRemoteAcceleration, kPredictor},
                                       {Law::kRemoteAcceleration, kInnovation},
                                       {Law::kRemoteAcceleration, kThesis},
                                       {Law::kRemoteAcceleration, kNone},
                                       {Law::kLocal, kPredictor},
                                       {Law::kLocal, kNone}}};

struct Run {
  DelayTrial trial;
  double rtt_ms = 0.0;
  double jitter_ms = 0.0;
  double loss = 0.0;
  std::string profile;    ///< empty: the three figures above
  std::string condition;  ///< what is special about it
  DelayResult result;
};

struct Options {
  // Of what is not given: the default, and no condition.
  std::optional<Law> law;
  std::optional<master::MakeEstimator> estimator;
  std::optional<codec::CodecChoice> codec;
  std::string netem;
  std::optional<double> rtt_ms, jitter_ms, loss;
  int block = DelayTrial{}.block;
  int redundancy = DelayTrial{}.redundancy;
  double duration_s = 8.0;
  std::uint64_t seed = 1;
  std::string out = "out/delay";
  bool one() const {
    return law || estimator || codec || !netem.empty() || rtt_ms || jitter_ms || loss ||
           block != DelayTrial{}.block || redundancy != DelayTrial{}.redundancy;
  }
};

Run make_run(const Pair& pair, const codec::CodecChoice& codec, double rtt_ms, double jitter_ms, double loss,
             std::uint64_t seed) {
  Run run;
  run.trial.law = pair.law;
  run.trial.estimator = pair.estimator;
  run.trial.codec = codec;
  run.trial.seed = seed;
  run.trial.network = netem::simple_profile(rtt_ms * 1e-3, jitter_ms * 1e-3, loss);
  run.rtt_ms = rtt_ms;
  run.jitter_ms = jitter_ms;
  run.loss = loss;
  return run;
}

/// The forward way grows by `more_s` in the middle of the run.
void step_delay(netem::DirectionProfile& direction, double at_s, double more_s) {
  netem::Stage later = direction.stages.back();
  later.from_s = at_s;
  later.conditions.delay.delay_s += more_s;
  direction.stages.push_back(later);
}

std::vector<Run> full_benchmark(std::uint64_t seed, double duration_s) {
  std::vector<Run> runs;
  for (const Pair& pair : kPairs) {
    for (const double rtt_ms : kRttMs) {
      for (const double share : {0.0, 0.1}) {
        if (rtt_ms == 0.0 && share > 0.0) continue;  // no jitter without delay
        for (const double loss : kLoss) {
          for (const codec::CodecChoice& codec : {codec::kDefaultCodec, *codec::kCodecs.find("raw")}) {
            runs.push_back(make_run(pair, codec, rtt_ms, share * rtt_ms, loss, seed));
          }
        }
      }
    }
    for (const char* profile : kProfiles) {
      Run run = make_run(pair, codec::kDefaultCodec, 0.0, 0.0, 0.0, seed);
      run.profile = profile;
      run.trial.network = netem::load_profile(profile);
      runs.push_back(run);
    }
    Run wrong = make_run(pair, codec::kDefaultCodec, 100.0, 0.0, 0.0, seed);
    wrong.condition = "wrong-start";
    wrong.trial.wrong_start = true;
    runs.push_back(wrong);
    Run push = make_run(pair, codec::kDefaultCodec, 100.0, 0.0, 0.0, seed);
    push.condition = "push-1-n";
    push.trial.push_n = 1.0;
    runs.push_back(push);
    Run step = make_run(pair, codec::kDefaultCodec, 100.0, 0.0, 0.0, seed);
    step.condition = "delay-step-50-ms";
    step_delay(step.trial.network.forward, 0.5 * duration_s, 0.05);
    runs.push_back(step);
  }
  return runs;
}

Run one_run(const Options& options) {
  const Pair pair{options.law.value_or(Law::kAnchored), options.estimator.value_or(kPredictor)};
  Run run = make_run(pair, options.codec.value_or(codec::kDefaultCodec), options.rtt_ms.value_or(0.0),
                     options.jitter_ms.value_or(0.0), options.loss.value_or(0.0), options.seed);
  if (!options.netem.empty()) {
    if (options.rtt_ms || options.jitter_ms || options.loss) {
      throw usage_error(
          "--netem says everything about the network: give either it or --rtt-ms, --jitter-ms, --loss");
    }
    run.profile = std::filesystem::path(options.netem).stem().string();
    run.trial.network = netem::load_profile(options.netem);
  }
  run.trial.block = options.block;
  run.trial.redundancy = options.redundancy;
  (void)master_settings(run.trial);  // refused here, before any thread runs
  return run;
}

void run_all(std::vector<Run>& runs, double duration_s, std::uint64_t seed) {
  const HandRecord hand = record_hand("heart", duration_s, seed);
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < runs.size(); i = next++) {
      runs[i].result = run_trial(hand, runs[i].trial);
      if (!(runs.size() == 1)) {
        runs[i].result.error_m.clear();
        runs[i].result.prediction_error_m.clear();
      }
      if (++done % 100 == 0) fmt::print("{} of {} runs\n", done.load(), runs.size()), std::fflush(stdout);
    }
  };
  const unsigned threads = std::min<unsigned>(std::max(1U, std::thread::hardware_concurrency()),
                                              static_cast<unsigned>(runs.size()));
  std::vector<std::jthread> workers;
  for (unsigned t = 0; t < threads; ++t) workers.emplace_back(work);
}

nlohmann::ordered_json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

nlohmann::ordered_json row_of(const Run& run) {
  nlohmann::ordered_json row;
  row["law"] = word_of(run.trial.law);
  row["estimator"] = word_of(run.trial.estimator);
  row["codec"] = codec::kCodecs.word(run.trial.codec);
  const bool named = !run.profile.empty();
  row["rtt_ms"] = named ? nlohmann::ordered_json() : number(run.rtt_ms);
  row["jitter_ms"] = named ? nlohmann::ordered_json() : number(run.jitter_ms);
  row["loss"] = named ? nlohmann::ordered_json() : number(run.loss);
  row["profile"] = named ? nlohmann::ordered_json(run.profile) : nlohmann::ordered_json();
  row["condition"] = run.condition.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(run.condition);
  const DelayResult& r = run.result;
  row["tracking_rmse_um"] = number(r.tracking_rmse_um);
  row["tracking_max_um"] = number(r.tracking_max_um);
  row["prediction_rmse_um"] = number(r.prediction_rmse_um);
  row["prediction_max_um"] = number(r.prediction_max_um);
  row["settle_s"] = number(r.settle_s);
  row["stable"] = r.stable;
  row["wire_bytes_per_s"] = number(r.wire_bytes_per_s);
  row["total_ms"] = number(r.total_ms);
  return row;
}

double of(const std::vector<Run>& runs, const Pair& pair, double rtt_ms, double share, double loss,
          double DelayResult::*what) {
  for (const Run& run : runs) {
    if (run.trial.law == pair.law && run.trial.estimator == pair.estimator &&
        run.trial.codec == codec::kDefaultCodec && run.profile.empty() && run.condition.empty() &&
        run.rtt_ms == rtt_ms && run.loss == loss && std::abs(run.jitter_ms - share * rtt_ms) < 1e-9) {
      return run.result.*what;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void draw_rtt(const std::vector<Run>& runs, const std::filesystem::path& png) {
  Figure figure;
  figure.title = "SDCT, jitter 10 % of the round trip, loss 0.01";
  figure.columns = 2;
  for (const auto& [title, what] :
       {std::pair{"slave to master (um rms)", &DelayResult::tracking_rmse_um},
        std::pair{"slave to its prediction (um rms)", &DelayResult::prediction_rmse_um}}) {
    Panel panel{.title = title, .x_label = "round trip (ms)", .y_label = "um", .log_y = true};
    panel.y_range = {{kLeast_um, kMost_um}};
    int colour = 0;
    for (const Pair& pair : kPairs) {
      Line line{.label = word_of(pair.law) + " + " + word_of(pair.estimator), .colour = colour++ % 8};
      if (colour > 8) line.style = Line::Style::kDashed;
      for (const double rtt_ms : kRttMs) {
        line.x.push_back(rtt_ms);
        const double value = of(runs, pair, rtt_ms, 0.1, 0.01, what);
        line.y.push_back(std::isfinite(value) ? std::clamp(value, kLeast_um, kMost_um) : kMost_um);
      }
      panel.lines.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  figure.panel_width_px = 780;
  figure.panel_height_px = 460;
  draw_figure(figure, png);
}

/// How far the largest stable w D is from theory, measured on a grid of 4 % steps.
void draw_stability(const std::filesystem::path& png) {
  Figure figure;
  figure.title = "u = -2 w v - w^2 x on a double integrator behind a delay D";
  figure.columns = 2;
  for (const master::MakeEstimator estimator : {kNone, kPredictor}) {
    Panel panel{.title = "estimator " + word_of(estimator),
                .x_label = "D (ms)",
                .y_label = "w (rad/s)",
                .log_x = true,
                .log_y = true};
    Line stable{.label = "stable", .style = Line::Style::kPoints, .colour = 2};
    Line unstable{.label = "unstable", .style = Line::Style::kPoints, .colour = 3};
    Line theory{.label = "w D = 0.6475", .colour = 0};
    for (double delay_s = 0.01; delay_s < 1.05; delay_s *= 1.35) {
      for (double w = 0.4; w < 110.0; w *= 1.35) {
        Line& line = law_is_stable(estimator, w, delay_s) ? stable : unstable;
        line.x.push_back(delay_s * 1e3);
        line.y.push_back(w);
      }
      theory.x.push_back(delay_s * 1e3);
      theory.y.push_back(0.6475 / delay_s);
    }
    panel.lines = {stable, unstable, theory};
    figure.panels.push_back(panel);
  }
  draw_figure(figure, png);
}

void draw_start(const std::filesystem::path& png) {
  Figure figure;
  figure.title = "Prediction error on an exact double integrator, round trip 100 ms";
  figure.columns = 2;
  for (const auto& [title, start] : {std::pair{"exact start, nothing disturbs", IdealStart{}},
                                     std::pair{"10 mm and 50 mm/s wrong at the start",
                                               IdealStart{.position_m = 0.01, .velocity_m_per_s = 0.05}}}) {
    Panel panel{.title = title, .x_label = "t (s)", .y_label = "um", .log_y = true};
    panel.y_range = {{1e-3, 2e6}};
    int colour = 0;
    for (const master::MakeEstimator estimator : {kNone, kThesis, kInnovation, kPredictor}) {
      Line line{.label = word_of(estimator), .colour = colour++};
      const auto errors = prediction_error(estimator, 0.1, 10.0, start);
      for (std::size_t i = 0; i < errors.size(); i += 10) {
        line.x.push_back(static_cast<double>(i) * 1e-3);
        line.y.push_back(std::max(errors[i] * 1e6, 1e-3));
      }
      panel.lines.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  draw_figure(figure, png);
}

void print_row(const Run& run) {
  const std::string network = run.profile.empty() ? fmt::format("{:.0f} ms, jitter {:.0f} ms, loss {:g}",
                                                                run.rtt_ms, run.jitter_ms, run.loss)
                                                  : run.profile;
  fmt::print("{:<20}{:<20}{:<6}{:<34}{:<18}tracking {:9.1f} um, prediction {:9.1f} um, {}\n",
             word_of(run.trial.law), word_of(run.trial.estimator), codec::kCodecs.word(run.trial.codec),
             network, run.condition, run.result.tracking_rmse_um, run.result.prediction_rmse_um,
             run.result.stable ? "stable" : "NOT STABLE");
}

int run(Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Run> runs =
      options.one() ? std::vector<Run>{one_run(options)} : full_benchmark(options.seed, options.duration_s);
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  run_all(runs, options.duration_s, options.seed);
  nlohmann::ordered_json json;
  json["seed"] = options.seed;
  json["rows"] = nlohmann::ordered_json::array();
  for (const Run& run : runs) json["rows"].push_back(row_of(run));
  write_json(folder / "delay.json", json);
  if (!options.one()) {
    draw_rtt(runs, folder / "delay.png");
    draw_stability(folder / "stability.png");
    draw_start(folder / "start.png");
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  write_json(folder / "timing.json",
             nlohmann::ordered_json{{"seconds", took.count()}, {"runs", runs.size()}});
  bool good = true;
  for (const Run& run : runs) {
    if (options.one() || !run.profile.empty() || !run.condition.empty()) print_row(run);
    // The bar of its own: the default law is stable everywhere.
    if (run.trial.law == Law::kAnchored && run.trial.estimator == kPredictor)
      good = good && run.result.stable;
  }
  if (options.one()) good = runs.front().result.stable;
  fmt::print("{} runs in {:.0f} s: {}/delay.json\n", runs.size(), took.count(), options.out);
  return good ? 0 : 1;
}

void add_parameters(Options& o, Settings& s) {
  s.add("law", o.law, master::kLaws, "who computes the slave's acceleration; without it anchored");
  s.add("estimator", o.estimator, master::kEstimators,
        "how the slave's state is predicted; without it predictor");
  s.add("codec", o.codec, codec::kCodecs, "of the command stream; without it sdct");
  s.add("block", o.block, {.min = 4, .max = 64}, "samples a block of it");
  s.add("redundancy", o.redundancy, {.min = 0, .max = 7}, "previous blocks repeated in a packet");
  s.add("netem", o.netem, kProfile, "network profile: a shipped name or a file");
  s.add("rtt_ms", o.rtt_ms, {.min = 0, .max = 10000, .unit = "ms"},
        "round trip; without it 0 if another condition is given");
  s.add("jitter_ms", o.jitter_ms, {.min = 0, .max = 10000, .unit = "ms"},
        "one way, standard deviation; without it 0");
  s.add("loss", o.loss, {.min = 0, .max = 1}, "as a fraction; without it 0");
  s.add("duration_s", o.duration_s, {.min = 2, .max = 600, .unit = "s"}, "length of every run");
  s.add("seed", o.seed, kSeeds, "of everything random");
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_delay_command(Program& program) {
  program.add("delay", "Laws and estimators across delays: delay.json, plots; any condition given: one run",
              Options{}, add_parameters, run);
}

}  // namespace telekerf::experiments
