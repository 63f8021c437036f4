// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment pictures: laps round every shipped picture, over shipped networks, with some seeds
// each.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "common/reporting/page_tables.h"
#include "common/reporting/run_report.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/parallel.h"
#include "experiments/quick_form.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

struct Options : QuickForm {
  std::vector<std::string> netem{"wifi-quiet", "leo", "wifi", "hostile"};
  int seeds = 5;
  double duration_s = 30.0;
  std::uint64_t seed = 1;
  int jobs = 0;
  std::string page;
  std::string out = "out/pictures";
};

struct Lap {
  std::string network, image;
  std::uint64_t seed = 0;
  ordered_json row;
};

ordered_json row_of(const Lap& lap, double duration_s) {
  ordered_json row{{"network", lap.network}, {"image", lap.image}, {"seed", lap.seed}};
  try {
    simulation::SimulationSettings settings;
    settings.image = lap.image;
    settings.network = netem::load_profile(lap.network);
    settings.seed = lap.seed;
    settings.duration_s = duration_s;
    const ordered_json report = reporting::make_report(simulation::simulate(settings));
    for (const char* part : {"tracking", "cut"}) row[part] = report[part];
  } catch (const StartupError& error) {
    row["ended"] = error.what();
  }
  return row;
}

/// Of one network's laps the figures at this place that were measured, the least first.
std::vector<double> sorted(const std::vector<Lap>& laps, const std::string& network,
                           const ordered_json::json_pointer& place) {
  std::vector<double> values;
  for (const Lap& lap : laps)
    if (lap.network == network && lap.row.contains(place) && lap.row[place].is_number())
      values.push_back(lap.row[place].get<double>());
  std::sort(values.begin(), values.end());
  return values;
}

reporting::PageTable table_of(const std::vector<Lap>& laps, const std::vector<std::string>& networks) {
  reporting::TableRows rows{{"network", "runs", "tracked", "tracking rms um", "lit",
                             "furthest from the master, beam on, um", "cut rms um", "cut furthest um",
                             "coverage %", "outside J"}};
  for (const std::string& network : networks) {
    const auto of = [&](const char* place) {
      return sorted(laps, network, ordered_json::json_pointer(place));
    };
    const auto median_and_worst = [](const std::vector<double>& values, bool least_is_worst, double unit) {
      if (values.empty()) return std::string("-");
      return fmt::format("{:.3g} / {:.3g}", unit * values[values.size() / 2],
                         unit * (least_is_worst ? values.front() : values.back()));
    };
    const auto largest = [](const std::vector<double>& values) {
      return values.empty() ? std::string("-") : fmt::format("{:.3g}", values.back());
    };
    const auto runs =
        std::count_if(laps.begin(), laps.end(), [&](const Lap& lap) { return lap.network == network; });
    const std::vector<double> tracking = of("/tracking/rms_um"), cut = of("/cut/rms_um");
    rows.push_back({network, std::to_string(runs), std::to_string(tracking.size()),
                    median_and_worst(tracking, false, 1.0), std::to_string(cut.size()),
                    largest(of("/tracking/laser_on/max_um")), median_and_worst(cut, false, 1.0),
                    largest(of("/cut/max_um")), median_and_worst(of("/cut/coverage"), true, 100.0),
                    largest(of("/cut/energy_outside_corridor_j"))});
  }
  return {"pictures", reporting::markdown_table(rows)};
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  std::vector<Lap> laps;
  for (const std::string& network : options.netem)
    for (const std::string& image : shipped_names("pictures", ".png"))
      for (int i = 0; i < options.seeds; ++i)
        laps.push_back({network, image, options.seed + static_cast<std::uint64_t>(i), {}});
  std::atomic<std::size_t> done{0};
  for_each_parallel(
      laps.size(),
      [&](std::size_t i) {
        laps[i].row = row_of(laps[i], options.duration_s);
        if (++done % 20 == 0) {
          fmt::print("{} of {}\n", done.load(), laps.size());
          std::fflush(stdout);
        }
      },
      static_cast<unsigned>(options.jobs));
  ordered_json rows = ordered_json::array();
  for (const Lap& lap : laps) rows.push_back(lap.row);
  write_json(folder / "pictures.json", ordered_json{{"experiment", "pictures"},
                                                    {"seed", options.seed},
                                                    {"duration_s", options.duration_s},
                                                    {"rows", rows}});
  const reporting::PageTable table = table_of(laps, options.netem);
  fmt::print("{}", table.markdown);
  if (!options.page.empty()) reporting::write_tables(options.page, {table});
  const bool good = std::all_of(laps.begin(), laps.end(), [](const Lap& lap) {
    return !lap.row.contains("ended") && reporting::stayed_inside(lap.row);
  });
  return good ? 0 : 1;
}

}  // namespace

void add_pictures_command(Program& program) {
  program.add(
      "pictures",
      "Laps round every shipped picture, over shipped networks: pictures.json; exit code 1 if one burns "
      "outside or "
      "cannot be run",
      Options{},
      [](Options& o, Settings& s) {
        s.add("netem", o.netem, kProfile, "network profiles: shipped names or files");
        s.add("seeds", o.seeds, {.min = 1, .max = 1000}, "runs of each picture and network, from --seed on");
        s.add("duration_s", o.duration_s, {.min = 2, .max = 600, .unit = "s"}, "length of a run");
        s.add("seed", o.seed, kSeeds, "of the first run");
        o.add_quick(
            s, {QuickForm::shorter("seeds", o.seeds, 1), QuickForm::shorter("duration_s", o.duration_s, 5)},
            {"page"});
        s.add("jobs", o.jobs, {.min = 0, .max = 256}, "runs at a time, 0: one a processor");
        s.add("page", o.page, kFile, "page whose table 'pictures' is written anew");
        s.add("out", o.out, kFolder, "folder for the results");
      },
      run);
}

}  // namespace telekerf::experiments
