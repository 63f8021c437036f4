// SPDX-License-Identifier: Apache-2.0
// What the thesis says, and where our figure for it stands: data, read from experiments/report/claims.toml.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/enum_table.h"

namespace telekerf::experiments {

/// A command of telekerf-experiment as `all` runs it; --seed and --out come on top, and --quick of a short
/// run.
struct ManifestExperiment {
  std::string key;   ///< in the manifest, "experiment.0."
  std::string name;  ///< of its folder
  std::string command;
  std::string title;
  std::string reference;                     ///< section of the thesis
  std::string result;                        ///< JSON file that it leaves
  std::vector<std::string> arguments;        ///< of a whole run
  std::vector<std::string> quick_arguments;  ///< beside --quick
  double cost_s = 1.0;                       ///< of processor time, about; for the order and the progress bar
};

struct ManifestFigure {
  std::string key;  ///< "figure.0."
  std::string experiment;
  std::string file;
  std::string caption;
  bool quick = true;  ///< false: a short run leaves none
};

enum class Relation { kWithin, kAtMost, kAtLeast };
enum class ClaimSection { kThesis, kRivals, kBeyond };

struct Claim {
  std::string key;  ///< "claim.0."
  std::string id;
  ClaimSection section = ClaimSection::kThesis;
  std::string experiment;
  std::string reference;  ///< section, equation or figure of the thesis
  std::string statement;  ///< the thesis', or ours
  std::string printed;    ///< the number that the thesis gives; empty: none is printed
  std::string quantity;   ///< what our figure is
  std::string unit;
  std::string pointer;  ///< into the experiment's result, see select()
  double factor = 1.0;  ///< from the result's unit to `unit`
  Relation relation = Relation::kAtMost;
  double bound = 0.0;      ///< in `unit`
  double tolerance = 0.0;  ///< of kWithin
  std::string reason;      ///< why the bound is where it is; empty: the manifest's head says it
  bool quick = true;       ///< false: a short run cannot judge it
  bool negative = false;   ///< known not to hold: stays on the page, and does not fail the run
  bool headline = false;   ///< stands in the README
};

struct Manifest {
  std::string file;  ///< as errors name it
  std::vector<ManifestExperiment> experiments;
  std::vector<ManifestFigure> figures;
  std::vector<Claim> claims;

  const ManifestExperiment& experiment(const std::string& name) const;
};

/// Throws StartupError that names file, key and remedy.
Manifest load_manifest(const std::filesystem::path& file);

/// The words behind the program's name, without --out.
std::vector<std::string> command_words(const ManifestExperiment& experiment, std::uint64_t seed, bool quick);
/// The command line that a reader types for one experiment, in the top folder of the source.
std::string command_line(const ManifestExperiment& experiment, std::uint64_t seed, bool quick);

/// "at most 8 um", "within 2 +- 0.1 mm/s".
std::string bound_text(const Claim& claim);
/// "no number printed" of the thesis' claims without one; "-" of the others.
std::string printed_text(const Claim& claim);

}  // namespace telekerf::experiments
