// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment machine: what telekerf-machine does, in virtual time, of every shipped picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "experiments/commands.h"
#include "experiments/machining/contour_tables.h"
#include "experiments/quick_form.h"
#include "experiments/simulation/simulation.h"
#include "slave/machining/station.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

struct Options : QuickForm {
  std::vector<std::string> image;
  double speed_mm_s = 20.0;
  std::uint64_t seed = 1;
  std::string page;
  std::string out = "out/machine";
};

/// The whole work of one picture, as the process leaves it.
ordered_json worked_off(const std::string& image, const Options& options) {
  machining::StationSettings settings;
  settings.speed_mm_s = options.speed_mm_s;
  settings.seed = options.seed;
  simulation::SimulationSettings vision;
  vision.image = image;
  vision.slave.robot = settings.robot;
  machining::Station station(settings);
  const auto job = station.prepare(simulation::find_contour(vision));
  station.begin(*job);
  const double period_ns = 1e9 / station.control_hz();
  LoopStatistics loop{.rate_hz = station.control_hz()};
  for (; !station.ended(); ++loop.steps)
    station.step(std::llround(static_cast<double>(loop.steps) * period_ns), false);
  station.release();
  const std::string name = std::filesystem::path(image).stem().string();
  const std::filesystem::path folder = std::filesystem::path(options.out) / name;
  make_folder("--out", folder);
  ordered_json result{{"image", name}};
  result.update(station.report(folder, loop));
  return result;
}

int run(const Options& options) {
  make_folder("--out", options.out);
  const std::vector<std::string> images =
      options.image.empty() ? shipped_names("pictures", ".png") : options.image;
  ordered_json rows = ordered_json::array();
  for (const std::string& image : images) {
    rows.push_back(worked_off(image, options));
    fmt::print("{} of {}: {}\n", rows.size(), images.size(), image);
  }
  write_json(std::filesystem::path(options.out) / "result.json",
             ordered_json{{"experiment", "machine"},
                          {"seed", options.seed},
                          {"speed_mm_s", options.speed_mm_s},
                          {"pictures", rows}});
  const reporting::PageTable table = machine_table(rows);
  fmt::print("{}", table.markdown);
  if (!options.page.empty()) reporting::write_tables(options.page, {table});
  const bool good = std::all_of(rows.begin(), rows.end(), [](const ordered_json& row) {
    return row["finished"] == true && row["burn"]["energy_outside_corridor_j"] == 0.0;
  });
  return good ? 0 : 1;
}

}  // namespace

void add_machine_command(Program& program) {
  program.add(
      "machine",
      "What telekerf-machine does, in virtual time: result.json, and of each picture what the process "
      "leaves; exit "
      "code 1 if one is not finished or burns outside",
      Options{},
      [](Options& o, Settings& s) {
        s.add("image", o.image, kPicture, "pictures: shipped names or files; none: every shipped one");
        s.add("speed_mm_s", o.speed_mm_s, {.min = 0.1, .max = 100, .unit = "mm/s"}, "tangential speed");
        s.add("seed", o.seed, kSeeds, "of the simulated robot");
        o.add_quick(s, {QuickForm::shorter("image", o.image, std::vector<std::string>{"heart", "letter-e"})},
                    {"page"});
        s.add("page", o.page, kFile, "page whose table 'machine' is written anew");
        s.add("out", o.out, kFolder, "folder for the results");
      },
      run);
}

}  // namespace telekerf::experiments
