// SPDX-License-Identifier: Apache-2.0
#include "experiments/replay/what_if.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "common/runtime/startup_error.h"
#include "experiments/lap_options.h"
#include "experiments/replay/replay.h"

namespace telekerf::experiments {

namespace fs = std::filesystem;

void refuse_recorded(std::span<const Setting> known, const ConfigFile& recorded, const ConfigFile& wanted) {
  for (const Setting& setting : known) {
    const auto stands = std::find_if(setting.conditions.begin(), setting.conditions.end(),
                                     [](const auto& c) { return c.other == LapOptions::kReplays; });
    if (stands == setting.conditions.end() || !wanted.has(setting.name)) continue;
    if (recorded.has(setting.name) && recorded.value(setting.name) == wanted.value(setting.name)) continue;
    throw usage_error(
        fmt::format("{}: {} has no effect in a replay: its {} is the recorded one; leave it out, or have "
                    "another run with "
                    "`telekerf-experiment lap {}`",
                    wanted.name(), setting.name, stands->words.front(), setting.flag()));
  }
}

void refuse_beyond_end(double duration_s, double recorded_s) {
  if (duration_s <= recorded_s + 1e-9) return;
  throw usage_error(
      fmt::format("duration_s = {:g} s: the hand is recorded for {:g} s, and nobody knows how it went on; "
                  "give at most that",
                  duration_s, recorded_s));
}

void refuse_taken_folder(const std::string& out, std::span<const fs::path> run) {
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(fs::absolute(out), ignored);
  for (const fs::path& folder : run) {
    const fs::path whose = fs::weakly_canonical(fs::absolute(folder), ignored);
    const auto [of_run, of_out] = std::mismatch(whose.begin(), whose.end(), place.begin(), place.end());
    if (of_run == whose.end())
      throw usage_error(
          fmt::format("--out {}: is the recorded run's own folder, or lies in it; name another, so that the "
                      "run stays as it is",
                      out));
  }
  if (!fs::is_directory(place, ignored) || fs::exists(place / kReplayFile, ignored)) return;
  if (!fs::is_empty(place, ignored))
    throw usage_error(fmt::format(
        "--out {}: holds files already, and they are not of a replay; name a new or an empty folder", out));
}

}  // namespace telekerf::experiments
