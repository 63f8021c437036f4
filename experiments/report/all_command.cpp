// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment all: every experiment of the manifest, its claims judged, one page.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "common/runtime/loop.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"
#include "experiments/commands.h"
#include "experiments/report/fit.h"
#include "experiments/report/judgement.h"
#include "experiments/report/manifest.h"
#include "experiments/report/page_marks.h"
#include "experiments/report/report_page.h"
#include "experiments/report/result_store.h"
#include "experiments/report/stored_claims.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct Options {
  bool quick = false;
  std::uint64_t seed = 1;
  int jobs = 2;
  std::vector<std::string> only;
  std::string claims;
  std::string against;
  std::string source;
  std::string out = "out/all";
};

/// "seed 1 -> 2, quick -> full", from the other run to this one; empty: the same.
std::string other_conditions(const ordered_json& before, const Options& now) {
  std::string out;
  const auto differs = [&](const std::string& what) { out += (out.empty() ? "" : ", ") + what; };
  if (before["seed"] != now.seed) differs(fmt::format("seed {} -> {}", before["seed"].dump(), now.seed));
  const bool quick = before["quick"];
  const auto form = [](bool is_quick) { return is_quick ? "quick" : "full"; };
  if (quick != now.quick) differs(fmt::format("{} -> {} form", form(quick), form(now.quick)));
  return out;
}

void refuse_unknown(const Options& options, const Manifest& manifest) {
  if (!options.source.empty() && (options.quick || !options.only.empty()))
    throw usage_error(
        "--source: the pages hold figures of full runs of everything; leave out --quick and --only");
  for (const std::string& name : options.only) {
    const auto named = [&](const ManifestExperiment& e) { return e.name == name; };
    if (std::any_of(manifest.experiments.begin(), manifest.experiments.end(), named)) continue;
    std::string names;
    for (const auto& experiment : manifest.experiments)
      names += (names.empty() ? "" : ", ") + experiment.name;
    throw usage_error(fmt::format("--only {}: must be one of {}", name, names));
  }
}

bool was_run(const std::vector<Finished>& finished, const std::string& name) {
  return std::any_of(finished.begin(), finished.end(), [&](const Finished& one) { return one.name == name; });
}

/// What the other run has otherwise, of the experiments of this one.
std::vector<std::string> changes_of_what_ran(const Manifest& manifest, const std::vector<Finished>& finished,
                                             std::vector<Judged> judged, ordered_json before) {
  std::set<std::string> not_run;
  for (const Claim& claim : manifest.claims)
    if (!was_run(finished, claim.experiment)) not_run.insert(claim.id);
  std::erase_if(judged, [&](const Judged& row) { return not_run.contains(row.claim.id); });
  ordered_json of_these = ordered_json::array();
  for (const auto& claim : before)
    if (!not_run.contains(claim["id"])) of_these.push_back(claim);
  return differences(judged, of_these);
}

/// "5 of 7 claims held; 147 are of experiments that were not asked for".
std::string count_text(const std::vector<Judged>& judged, const std::vector<Finished>& finished) {
  int held = 0, of = 0;
  for (const Judged& row : judged) {
    of += was_run(finished, row.claim.experiment) ? 1 : 0;
    held += row.verdict == Verdict::kHeld ? 1 : 0;
  }
  const int others = static_cast<int>(judged.size()) - of;
  return fmt::format("{} of {} claims held", held, of) +
         (others > 0 ? fmt::format("; {} are of experiments that were not asked for", others) : "");
}

/// Of an interrupted run; returns its exit code, as ./telekerf's.
int say_what_is_kept(const Manifest& manifest, const StorePlan& plan, const std::vector<Finished>& finished) {
  const auto of =
      std::count_if(manifest.experiments.begin(), manifest.experiments.end(), [&](const auto& one) {
        return plan.only.empty() ||
               std::find(plan.only.begin(), plan.only.end(), one.name) != plan.only.end();
      });
  fmt::print(stderr,
             "\ninterrupted: no page was written; {} of {} experiments are finished and kept in {}; {}\n",
             finished.size(), of, (plan.out / "results" / plan.commit).string(),
             is_a_commit(plan.commit) ? "the same command goes on behind them"
                                      : "this program was built from changes that are no commit, so the same "
                                        "command runs all of them again");
  return 130;
}

int run(const Options& options) {
  const Manifest manifest = load_manifest(options.claims.empty() ? find_resource("report", "claims", ".toml")
                                                                 : fs::path(options.claims));
  if (manifest.claims.empty()) throw input_error("--claims " + options.claims + ": holds no claim");
  refuse_unknown(options, manifest);
  if (!options.source.empty()) require_pages(options.source);
  ordered_json before;
  if (!options.against.empty()) before = stored_claims(options.against);
  const fs::path out = options.out;
  const StorePlan plan{.out = out,
                       .seed = options.seed,
                       .quick = options.quick,
                       .jobs = static_cast<unsigned>(options.jobs),
                       .only = options.only};
  catch_stop_signals();
  const std::vector<Finished> finished = run_experiments(manifest, plan);
  if (stop_requested()) return say_what_is_kept(manifest, plan, finished);
  const ResultsByName results = read_results(manifest, finished);
  require_fit(manifest, finished, results, options.quick);
  const std::vector<Judged> judged = judge(manifest, results, options.quick);
  const std::vector<std::string> changes =
      options.against.empty() ? std::vector<std::string>()
                              : changes_of_what_ran(manifest, finished, judged, before["claims"]);
  const std::string otherwise = options.against.empty() ? "" : other_conditions(before, options);
  write_json(out / "claims.json", ordered_json{{"version", kVersion},
                                               {"commit", plan.commit},
                                               {"seed", options.seed},
                                               {"quick", options.quick},
                                               {"claims", claims_json(judged)}});
  ReportPage page{.manifest = manifest,
                  .judged = judged,
                  .finished = finished,
                  .seed = options.seed,
                  .quick = options.quick,
                  .commit = plan.commit,
                  .differences = changes,
                  .against = fs::path(options.against).lexically_normal().filename().string(),
                  .other_conditions = otherwise,
                  .made = made_line(finished)};
  write_atomically(out / "report.html", report_page(page));
  bool good = all_held(judged), whole = true;
  for (const Finished& one : finished) {
    if (one.code > 1) fmt::print(stderr, "{}: could not be run: {}\n", one.name, one.complaint);
    whole = whole && one.code <= 1;
  }
  if (!options.source.empty() && whole) {
    write_pages(options.source, judged);
    page.against.clear();
    page.made.clear();  // when and where is nothing that a repository wants
    write_atomically(fs::path(options.source) / "docs/results/report.html", report_page(page));
  } else if (!options.source.empty()) {
    fmt::print(stderr, "the pages in {} stay as they are\n", options.source);
  }
  for (const Judged& row : judged)
    if (row.verdict != Verdict::kHeld && was_run(finished, row.claim.experiment))
      fmt::print("{}: {}{}\n", row.claim.id, verdict_text(row.verdict),
                 row.value
                     ? fmt::format(": {} {}, {}", value_text(row), row.claim.unit, bound_text(row.claim))
                     : ": " + row.why);
  for (const Judged& row : judged)
    if (const std::string remark = remark_of(row); row.verdict == Verdict::kHeld && !remark.empty())
      fmt::print("{}: {}: {} {}, {}\n", row.claim.id, remark, value_text(row), row.claim.unit,
                 bound_text(row.claim));
  if (!otherwise.empty())
    fmt::print("against {}: made otherwise ({}): what differs need not be the code's doing\n",
               options.against, otherwise);
  for (const std::string& line : changes) fmt::print("changed: {}\n", line);
  if (!options.against.empty() && changes.empty())
    fmt::print("against {}: no claim has another figure or verdict\n", options.against);
  fmt::print("{}: {}\n", count_text(judged, finished), (out / "report.html").string());
  return !whole ? 2 : good ? 0 : 1;
}

void add_parameters(Options& o, Settings& s) {
  s.add("quick", o.quick, "short forms: fewer pictures and runs; some claims are then not assessed");
  s.add("seed", o.seed, kSeeds, "of everything random");
  s.add("jobs", o.jobs, {.min = 1, .max = 64}, "experiments at a time");
  TextForm experiment{"EXPERIMENT"};
  experiment.complaint = [](const std::string&) { return std::string(); };  // the manifest knows them
  s.add("only", o.only, experiment, "these experiments alone, by the manifest's names");
  s.add("claims", o.claims, kFile, "another manifest than the shipped one");
  s.add("against", o.against, kFolder,
        "--out of another run: says which claims have another figure, and by how much");
  s.add("source", o.source, kFolder,
        "top folder of the source: README.md and docs/results there get their tables, figures and "
        "report.html anew");
  s.add("out", o.out, kFolder,
        "folder for report.html, claims.json and the results, by commit, experiment and seed");
}

}  // namespace

void add_all_command(Program& program) {
  program.add("all",
              "Every experiment, its claims held against the thesis, one page: report.html; what is there of "
              "the same commit "
              "and seed is not run again; exit code 1 if a claim is not held",
              Options{}, add_parameters, run);
}

}  // namespace telekerf::experiments
