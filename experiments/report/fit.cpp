// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

/// What of this kind lies in the folder, as a remedy names it.
std::string files_in(const fs::path& folder, const std::string& extension) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == extension && entry.path().filename() != "done.json")
      names.push_back(fs::relative(entry.path(), folder).generic_string());
  std::sort(names.begin(), names.end());
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out.empty() ? "none" : out;
}

[[noreturn]] void refuse(const Manifest& manifest, const std::string& key, const std::string& value,
                         const std::string& complaint) {
  throw configuration_error(fmt::format("{}: {} = \"{}\": {}", manifest.file, key, value, complaint));
}

}  // namespace

void require_fit(const Manifest& manifest, const std::vector<Finished>& finished,
                 const ResultsByName& results, bool quick) {
  const auto run_of = [&](const std::string& name) {
    const auto at = std::find_if(finished.begin(), finished.end(),
                                 [&](const Finished& one) { return one.name == name && one.code <= 1; });
    return at == finished.end() ? nullptr : &*at;
  };
  const std::string only_full = quick ? "; if only a full run has it, say quick = false" : "";
  for (const ManifestExperiment& experiment : manifest.experiments) {
    const Finished* run = run_of(experiment.name);
    if (run != nullptr && !results.contains(experiment.name))
      refuse(manifest, experiment.key + "result", experiment.result,
             fmt::format("{} leaves no such JSON file; name one of those that it leaves: {}", experiment.name,
                         files_in(run->folder, ".json")));
  }
  for (const ManifestFigure& figure : manifest.figures) {
    const Finished* run = run_of(figure.experiment);
    if (run != nullptr && (figure.quick || !quick) && !fs::is_regular_file(run->folder / figure.file))
      refuse(manifest, figure.key + "file", figure.file,
             fmt::format("{} leaves no such picture; name one of those that it leaves: {}{}",
                         figure.experiment, files_in(run->folder, ".png"), only_full));
  }
  for (const Claim& claim : manifest.claims) {
    const auto result = results.find(claim.experiment);
    if (result == results.end() || (quick && !claim.quick)) continue;
    const auto* node = node_at(result->second, claim.pointer);
    const std::string file = manifest.experiment(claim.experiment).result;
    if (node == nullptr)
      refuse(manifest, claim.key + "pointer", claim.pointer,
             fmt::format("claim {}: nothing stands there, or more than one thing, in {}'s {}; look there for "
                         "what it is called{}",
                         claim.id, claim.experiment, file, only_full));
    if (!node->is_number() && !node->is_boolean() && !node->is_null())
      refuse(manifest, claim.key + "pointer", claim.pointer,
             fmt::format("claim {}: what stands there in {}'s {} is no number; go on to one of its members",
                         claim.id, claim.experiment, file));
  }
}

}  // namespace telekerf::experiments
