// SPDX-License-Identifier: Apache-2.0
// Runs the experiments of the manifest, each as a process of its own, and keeps what they leave by commit,
// experiment and seed: OUT/results/COMMIT/EXPERIMENT/SEED. What is there already is not run again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/report/judgement.h"
#include "experiments/report/manifest.h"

namespace telekerf::experiments {

/// The source that this program was built from; "-changed" behind it: and something on top, or "unknown".
/// What such a program leaves is never taken for finished.
std::string built_commit();
bool is_a_commit(const std::string& commit);

struct StorePlan {
  std::filesystem::path out;
  std::string commit = built_commit();
  std::uint64_t seed = 1;
  bool quick = false;
  unsigned jobs = 2;
  std::vector<std::string> only;  ///< empty: all
};

struct Finished {
  std::string name;
  std::filesystem::path folder;
  int code = 2;           ///< of the process
  bool resumed = false;   ///< it was there already
  double seconds = 0.0;   ///< by the clock
  std::string complaint;  ///< what it said last if it could not be run
};

std::filesystem::path folder_of(const StorePlan& plan, const std::string& experiment);

/// In the manifest's order. Progress goes to standard error: a bar on a terminal, a line an experiment
/// elsewhere. Throws StartupError if a folder cannot be made or another run works in it. Once a stop is
/// requested (common/runtime/loop.h) what runs is ended, nothing more begins, and what is not finished is not
/// among them.
std::vector<Finished> run_experiments(const Manifest& manifest, const StorePlan& plan);

/// What they left.
ResultsByName read_results(const Manifest& manifest, const std::vector<Finished>& finished);

}  // namespace telekerf::experiments
