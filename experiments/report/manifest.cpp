// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/manifest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "common/runtime/config.h"
#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

constexpr EnumRow<Relation> kRelationRows[] = {
    {"within", Relation::kWithin, "bound plus or minus tolerance"},
    {"at_most", Relation::kAtMost, "no larger than bound"},
    {"at_least", Relation::kAtLeast, "no smaller than bound"},
};
constexpr EnumTable<Relation> kRelations(kRelationRows);

constexpr EnumRow<ClaimSection> kSectionRows[] = {
    {"thesis", ClaimSection::kThesis, "what the thesis says"},
    {"rivals", ClaimSection::kRivals, "ways that others go"},
    {"beyond", ClaimSection::kBeyond, "what the thesis does not have"},
};
constexpr EnumTable<ClaimSection> kSections(kSectionRows);

std::vector<std::string> words_at(const ConfigFile& file, const std::string& key) {
  const auto value = file.value(key);
  if (!value) return {};
  if (const auto* words = std::get_if<std::vector<std::string>>(&*value)) return *words;
  if (const auto* numbers = std::get_if<std::vector<double>>(&*value); numbers != nullptr && numbers->empty())
    return {};
  file.refuse(key, "must be a list of words");
}

ManifestExperiment experiment_at(const ConfigFile& file, const std::string& at) {
  ManifestExperiment out;
  out.key = at;
  out.name = file.text(at + "name");
  out.command = file.text_or(at + "command", out.name);
  out.title = file.text(at + "title");
  out.reference = file.text(at + "reference");
  out.result = file.text(at + "result");
  out.arguments = words_at(file, at + "arguments");
  out.quick_arguments =
      file.has(at + "quick_arguments") ? words_at(file, at + "quick_arguments") : out.arguments;
  out.cost_s = file.number_or(at + "cost_s", out.cost_s, {.min = 0.1, .max = 3600});
  return out;
}

Claim claim_at(const ConfigFile& file, const std::string& at) {
  Claim out;
  out.key = at;
  out.id = file.text(at + "id");
  out.section = file.choice_or(at + "section", out.section, kSections);
  out.experiment = file.text(at + "experiment");
  out.reference = file.text_or(at + "reference", "");
  out.statement = file.text(at + "statement");
  out.printed = file.text_or(at + "printed", "");
  out.quantity = file.text(at + "quantity");
  out.unit = file.text_or(at + "unit", "");
  out.pointer = file.text(at + "pointer");
  if (!out.pointer.starts_with('/')) file.refuse(at + "pointer", "must begin with '/', as \"/key/key\"");
  out.factor = file.number_or(at + "factor", out.factor);
  if (out.factor == 0.0)
    file.refuse(at + "factor", "must not be 0: every figure would be; leave it out for 1");
  out.relation = file.choice_or(at + "relation", out.relation, kRelations);
  out.bound = file.number(at + "bound");
  out.tolerance = file.number_or(at + "tolerance", out.tolerance, {.min = 0});
  if (out.tolerance > 0.0 && out.relation != Relation::kWithin)
    file.refuse(at + "tolerance", "is of relation = \"within\" alone; leave it out");
  if (out.relation == Relation::kWithin && !file.has(at + "tolerance"))
    file.refuse(at + "tolerance", "is what relation = \"within\" wants: state it, 0 for the bound alone");
  out.reason = file.text_or(at + "reason", "");
  out.quick = file.boolean_or(at + "quick", out.quick);
  out.negative = file.boolean_or(at + "negative", out.negative);
  out.headline = file.boolean_or(at + "headline", out.headline);
  return out;
}

}  // namespace

const ManifestExperiment& Manifest::experiment(const std::string& name) const {
  return *std::find_if(experiments.begin(), experiments.end(), [&](const auto& e) { return e.name == name; });
}

Manifest load_manifest(const std::filesystem::path& path) {
  const ConfigFile file(path);
  Manifest out{.file = file.name(), .experiments = {}, .figures = {}, .claims = {}};
  std::set<std::string> names, ids;
  const auto at = [](const char* table, std::size_t i) { return fmt::format("{}.{}.", table, i); };
  for (std::size_t i = 0; i < file.array_size("experiment"); ++i) {
    out.experiments.push_back(experiment_at(file, at("experiment", i)));
    if (!names.insert(out.experiments.back().name).second)
      file.refuse(at("experiment", i) + "name", "stands there twice");
  }
  const auto known = [&](const std::string& name, const std::string& key) {
    if (!names.contains(name))
      file.refuse(key, fmt::format("must be one of the experiments: {}", fmt::join(names, ", ")));
  };
  for (std::size_t i = 0; i < file.array_size("figure"); ++i) {
    const std::string key = at("figure", i);
    out.figures.push_back({key, file.text(key + "experiment"), file.text(key + "file"),
                           file.text(key + "caption"), file.boolean_or(key + "quick", true)});
    known(out.figures.back().experiment, key + "experiment");
  }
  for (std::size_t i = 0; i < file.array_size("claim"); ++i) {
    const std::string key = at("claim", i);
    out.claims.push_back(claim_at(file, key));
    known(out.claims.back().experiment, key + "experiment");
    if (!ids.insert(out.claims.back().id).second) file.refuse(key + "id", "stands there twice");
  }
  file.refuse_unknown();
  return out;
}

std::vector<std::string> command_words(const ManifestExperiment& experiment, std::uint64_t seed, bool quick) {
  std::vector<std::string> words{experiment.command};
  const auto& own = quick ? experiment.quick_arguments : experiment.arguments;
  words.insert(words.end(), own.begin(), own.end());
  if (quick) words.emplace_back("--quick");
  words.insert(words.end(), {"--seed", fmt::format("{}", seed)});
  return words;
}

std::string command_line(const ManifestExperiment& experiment, std::uint64_t seed, bool quick) {
  return fmt::format("./telekerf experiment {}", fmt::join(command_words(experiment, seed, quick), " "));
}

std::string bound_text(const Claim& claim) {
  const std::string unit = claim.unit.empty() ? "" : " " + claim.unit;
  switch (claim.relation) {
    case Relation::kWithin:
      return fmt::format("{:g} +- {:g}{}", claim.bound, claim.tolerance, unit);
    case Relation::kAtMost:
      return fmt::format("at most {:g}{}", claim.bound, unit);
    case Relation::kAtLeast:
      return fmt::format("at least {:g}{}", claim.bound, unit);
  }
  return "";
}

std::string printed_text(const Claim& claim) {
  if (!claim.printed.empty()) return claim.printed;
  return claim.section == ClaimSection::kThesis ? "no number printed" : "-";
}

}  // namespace telekerf::experiments
