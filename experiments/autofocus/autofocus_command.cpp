// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment autofocus: thesis 8.5, and searches from starts drawn at random beside their rivals.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "common/runtime/results.h"
#include "experiments/autofocus/focus_figures.h"
#include "experiments/autofocus/focus_story.h"
#include "experiments/autofocus/focus_surface.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

struct Options : QuickForm {
  imaging::FocusLaw law = imaging::FocusLaw::kSearch;
  int starts = 200;
  std::uint64_t seed = 1;
  int jobs = 0;
  std::string out = "out/autofocus";
  std::string page;
};

void print(const FocusFigures& figures) {
  fmt::print("{:<16}{:>10}{:>13}{:>10}{:>6}{:>12}\n", "strategy", "success %", "false locks", "pictures",
             "most", "error, dof");
  for (const StrategyRow& row : figures.rows) {
    fmt::print("{:<16}{:>10.1f}{:>13}{:>10}{:>6}{:>12.3f}\n", row.name, 100.0 * row.success_rate(),
               row.false_locks, row.pictures_p50, row.pictures_max, row.error_rms_dof);
  }
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  cv::setNumThreads(1);  // the starts share the processors, and the order of sums is the same everywhere
  const FocusPlan plan{.starts = options.starts,
                       .seed = options.seed,
                       .thesis_only = options.law == imaging::FocusLaw::kThesis,
                       .jobs = static_cast<unsigned>(options.jobs)};
  const FocusFigures figures = focus_figures(plan);
  print(figures);
  auto json = json_of(figures, plan);
  write_result(folder / "autofocus.json", json, options.seed);
  write_atomically(folder / "starts.csv", starts_csv(figures));
  if (!figures.steps.empty()) write_atomically(folder / "zooms.csv", zooms_csv(figures));
  draw_stories(options.seed, folder);
  draw_surface(options.seed, folder);
  if (plan.thesis_only) return 0;
  if (!options.page.empty()) reporting::write_tables(options.page, page_tables(figures));
  const auto bars = acceptance(figures);
  for (const Acceptance& bar : bars) bar.print();
  return std::all_of(bars.begin(), bars.end(), [](const Acceptance& bar) { return bar.met(); }) ? 0 : 1;
}

}  // namespace

void add_autofocus_command(Program& program) {
  program.add(
      "autofocus",
      "Thesis 8.5: autofocus from starts drawn at random, beside its rivals: autofocus.json and figures; "
      "exit code 1 "
      "if a bar is missed",
      Options{},
      [](Options& o, Settings& s) {
        s.add("law", o.law, imaging::kFocusLaws, "what is measured; thesis: it alone, without bars");
        s.add("starts", o.starts, {.min = 1, .max = 1e5}, "starts a target, with the seeds from --seed on");
        s.add("seed", o.seed, kSeeds, "of the first start");
        s.add("jobs", o.jobs, {.min = 0, .max = 256}, "starts at a time, 0: one a processor");
        o.add_quick(s, {QuickForm::shorter("starts", o.starts, 10)}, {"page"});
        s.add("out", o.out, kFolder, "folder for results and figures");
        s.add("page", o.page, kFile, "results page whose tables are written anew");
      },
      run);
}

}  // namespace telekerf::experiments
