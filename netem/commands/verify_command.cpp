// SPDX-License-Identifier: Apache-2.0
// telekerf-netem verify: measured against nominal, exit 1 when outside the bounds.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/runtime/results.h"
#include "netem/commands/commands.h"
#include "netem/core/random.h"
#include "netem/verify/verify.h"

namespace telekerf::netem {
namespace {

struct VerifyOptions {
  std::string profile;
  Traffic traffic;
  bool json = false;
};

nlohmann::json to_json(const StageReport& report) {
  nlohmann::json checks = nlohmann::json::array();
  for (const Check& check : report.checks) {
    nlohmann::json entry{{"name", check.name}, {"unit", check.unit}, {"measured", check.measured}};
    if (check.judged) {
      entry.update(
          {{"nominal", check.nominal}, {"low", check.low}, {"high", check.high}, {"good", check.good()}});
    }
    checks.push_back(entry);
  }
  return {{"direction", kDirections.word(report.direction)},
          {"from_s", report.from_s},
          {"good", report.good()},
          {"checks", checks}};
}

void print_table(const StageReport& report) {
  fmt::print("{}, from {:g} s\n", kDirections.word(report.direction), report.from_s);
  fmt::print("  {:<34} {:>12} {:>12}   {:<29}\n", "", "measured", "nominal", "bounds");
  for (const Check& check : report.checks) {
    if (!check.judged) {
      fmt::print("  {:<34} {:>12.6g} {:>12}   {:<29} {}\n", check.name, check.measured, "-", "not judged",
                 check.unit);
      continue;
    }
    fmt::print("  {:<34} {:>12.6g} {:>12.6g}   [{:>12.6g}, {:>12.6g}]  {:<8}{}\n", check.name, check.measured,
               check.nominal, check.low, check.high, check.unit, check.good() ? "" : "  OUTSIDE");
  }
}

int run_verify(const VerifyOptions& options) {
  const Profile profile = load_profile(options.profile);
  const auto reports = verify(profile, options.traffic);
  const bool good =
      std::all_of(reports.begin(), reports.end(), [](const StageReport& report) { return report.good(); });
  if (options.json) {
    nlohmann::json out{{"profile", profile.name},
                       {"packets", options.traffic.packets},
                       {"seed", options.traffic.seed},
                       {"good", good},
                       {"reports", nlohmann::json::array()}};
    for (const auto& report : reports) out["reports"].push_back(to_json(report));
    fmt::print("{}\n", json_text(out));
  } else {
    for (const auto& report : reports) print_table(report);
    fmt::print("{}: {} over {} packets each way, seed {}\n", profile.name,
               good ? "all within their bounds" : "OUTSIDE its bounds", options.traffic.packets,
               options.traffic.seed);
  }
  return good ? 0 : 1;
}

}  // namespace

void add_verify_command(Program& program) {
  program.add(
      "verify", "Sends virtual packets and holds what happens to them against the profile", VerifyOptions{},
      [](VerifyOptions& o, Settings& s) {
        s.add("profile", o.profile, kProfile, "a shipped name, a TOML file or a trace").as_argument();
        s.add("packets", o.traffic.packets, {.min = 100, .max = 20e6}, "in each direction (and stage)");
        s.add("seed", o.traffic.seed, kSeeds, "of the random numbers");
        s.add("rate_hz", o.traffic.rate_hz, {.min = 0.1, .max = 1e6, .unit = "Hz"}, "packets a second");
        s.add("json", o.json, "one JSON object instead of a table");
      },
      [](const VerifyOptions& o) { return run_verify(o); });
}

}  // namespace telekerf::netem
