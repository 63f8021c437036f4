// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment all: every experiment of the manifest, its claims judged, one page.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"
#include "experiments/commands.h"
#include "experiments/report/judgement.h"
#include "experiments/report/manifest.h"
#include "experiments/report/page_marks.h"
#include "experiments/report/report_page.h"
#include "experiments/report/result_store.h"

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

ordered_json claims_of(const fs::path& folder) {
  std::ifstream in(folder / "claims.json");
  if (!in)
    throw input_error("--against " + folder.string() +
                      ": holds no claims.json; name the --out of another run");
  auto json = ordered_json::parse(in, nullptr, false);
  const auto is_claim = [](const ordered_json& claim) {
    return claim.is_object() && claim.value("id", ordered_json()).is_string();
  };
  if (!json.is_object() || !json.contains("claims") || !json["claims"].is_array() ||
      !std::all_of(json["claims"].begin(), json["claims"].end(), is_claim))
    throw input_error("--against " + folder.string() + ": its claims.json is none of this program's");
  return json["claims"];
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

int run(const Options& options) {
  const Manifest manifest = load_manifest(options.claims.empty() ? find_resource("report", "claims", ".toml")
                                                                 : fs::path(options.claims));
  if (manifest.claims.empty()) throw input_error("--claims " + options.claims + ": holds no claim");
  refuse_unknown(options, manifest);
  ordered_json before;
  if (!options.against.empty()) before = claims_of(options.against);
  const fs::path out = options.out;
  const StorePlan plan{.out = out,
                       .seed = options.seed,
                       .quick = options.quick,
                       .jobs = static_cast<unsigned>(options.jobs),
                       .only = options.only};
  const std::vector<Finished> finished = run_experiments(manifest, plan);
  const std::vector<Judged> judged = judge(manifest, read_results(manifest, finished), options.quick);

  const std::vector<std::string> changes =
      options.against.empty() ? std::vector<std::string>() : differences(judged, before);
  write_json(out / "claims.json", ordered_json{{"version", kVersion},
                                               {"commit", plan.commit},
                                               {"seed", options.seed},
                                               {"quick", options.quick},
                                               {"claims", claims_json(judged)}});
  write_atomically(out / "report.html",
                   report_page({.manifest = manifest,
                                .judged = judged,
                                .finished = finished,
                                .seed = options.seed,
                                .quick = options.quick,
                                .commit = plan.commit,
                                .differences = changes,
                                .against = fs::path(options.against).lexically_normal().filename().string(),
                                .made = made_line(finished)}));
  if (!options.source.empty()) write_pages(options.source, judged);

  bool good = all_held(judged), whole = true;
  for (const Finished& one : finished) {
    if (one.code > 1) fmt::print(stderr, "{}: could not be run: {}\n", one.name, one.complaint);
    whole = whole && one.code <= 1;
  }
  for (const Judged& row : judged)
    if (row.verdict != Verdict::kHeld && was_run(finished, row.claim.experiment))
      fmt::print("{}: {}{}\n", row.claim.id, verdict_text(row.verdict),
                 row.value
                     ? fmt::format(": {} {}, {}", value_text(row), row.claim.unit, bound_text(row.claim))
                     : ": " + row.why);
  for (const std::string& line : changes) fmt::print("changed: {}\n", line);
  const auto held = std::count_if(judged.begin(), judged.end(),
                                  [](const Judged& r) { return r.verdict == Verdict::kHeld; });
  fmt::print("{} of {} claims held: {}\n", held, judged.size(), (out / "report.html").string());
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
        "top folder of the source: README.md and docs/results there get their tables and figures anew");
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
