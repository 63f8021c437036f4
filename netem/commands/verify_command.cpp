// SPDX-License-Identifier: Apache-2.0
// telekerf-netem verify: measured against nominal, exit 1 when outside the bounds.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/runtime/results.h"
#include "netem/commands/commands.h"
#include "netem/verify/verify.h"

namespace telekerf::netem {
namespace {

struct Options {
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

int run(const Options& options) {
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

void add_verify_command(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand(
      "verify", "Sends virtual packets and holds what happens to them against the profile");
  auto options = std::make_shared<Options>();
  command->add_option("profile", options->profile, "a shipped name, a TOML file or a trace")->required();
  command->add_option("--packets", options->traffic.packets, "in each direction (and stage)")
      ->check(within(100, 20e6))
      ->capture_default_str();
  command->add_option("--seed", options->traffic.seed, "of the random numbers")
      ->check(whole_number())
      ->capture_default_str();
  command->add_option("--rate-hz", options->traffic.rate_hz, "packets per second")
      ->check(within(0.1, 1e6))
      ->capture_default_str();
  command->add_flag("--json", options->json, "one JSON object instead of a table");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace telekerf::netem
