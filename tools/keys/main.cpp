// SPDX-License-Identifier: Apache-2.0
// telekerf-keys DIR: makes, looks at and renews the keys of secured cells; ./telekerf keys starts it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/security/keystore.h"
#include "common/bus/security/keystore_check.h"
#include "common/bus/security/roles.h"
#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"

namespace telekerf::security {
namespace {

constexpr int kWarnDays = 30;

struct Options {
  std::string dir;
  std::string cells;
  int days = 365;
  bool check = false;
  bool renew = false;

  void validate() const {
    if (check && renew)
      throw usage_error("--check and --renew do not go together: one looks, the other writes");
    if (check && !cells.empty())
      throw usage_error("--cells has no effect with --check: all cells are looked at");
  }
};

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream words(list);
  for (std::string name; std::getline(words, name, ',');) names.push_back(name);
  return names;
}

std::string complaint_about_cells(const std::string& list) {
  for (const std::string& name : names_in(list)) {
    if (const std::string wrong = complaint_about_secured_cell(name); !wrong.empty())
      return fmt::format("cell '{}' {}", name, wrong);
  }
  return "";
}

std::string lasting(const KeystoreReport& report) {
  if (!report.first_to_end) return "";
  const auto& first = *report.first_to_end;
  return fmt::format("{} days left (until {})", days_left(first.end, std::chrono::system_clock::now()),
                     text_of(first.end));
}

int look(const Options& options) {
  std::error_code error;
  if (!std::filesystem::is_directory(options.dir, error) && error != std::errc::permission_denied)
    throw input_error(
        fmt::format("{}: is no folder; ./telekerf keys {} makes the keys", options.dir, options.dir));
  const KeystoreReport report = check_keystore(options.dir, std::chrono::system_clock::now());
  for (const std::string& fault : report.faults) fmt::print("keys: {}\n", fault);
  for (const std::string& note : report.notes) fmt::print("keys: {}\n", note);
  if (report.identities == 0) return 1;
  const std::string state = fmt::format("{} identities in cells {}, {}", report.identities,
                                        fmt::join(cells_of(options.dir), ", "), lasting(report));
  if (!report.faults.empty()) {
    fmt::print("keys: {} faults; {}\n", report.faults.size(), state);
    return 1;
  }
  if (days_left(report.first_to_end->end, std::chrono::system_clock::now()) < kWarnDays)
    fmt::print("keys: {} ends soon; ./telekerf keys {} --renew\n", report.first_to_end->file, options.dir);
  fmt::print("keys: good; {}\n", state);
  return 0;
}

int run(const Options& options) {
  if (options.check) return look(options);
  const auto life = std::chrono::hours(24) * options.days;
  std::vector<std::string> cells = names_in(options.cells);
  std::vector<std::filesystem::path> authorities;
  if (options.renew) {
    authorities = renew_keystore(options.dir, cells, life);
  } else {
    if (cells.empty()) cells.emplace_back("cell-1");
    make_keystore(options.dir, cells, life);
  }
  const KeystoreReport report = check_keystore(options.dir, std::chrono::system_clock::now());
  if (!report.faults.empty()) throw environment_error(report.faults.front());
  fmt::print("keys: {} identities in cells {} are in {}, {}\n", report.identities,
             fmt::join(cells_of(options.dir), ", "), options.dir, lasting(report));
  for (const std::filesystem::path& file : authorities)
    fmt::print(
        "keys: {} would have ended before them and is renewed, too: copy it with the rest, and start "
        "every process of every cell anew, for those with the old one do not hear those with the new\n",
        file.string());
  fmt::print(
      "keys: keep {0}/*.key here; copy the rest to each computer, of the private keys "
      "(cells/CELL/ROLE/key.pem) only "
      "those of the roles that run there; start every process with --security {0}\n",
      options.dir);
  return 0;
}

void add_parameters(Options& options, Settings& settings) {
  settings
      .add("dir", options.dir, TextForm{.form = "DIR", .complaint = [](const std::string&) { return ""; }},
           "folder of the keys")
      .as_argument();
  settings.add(
      "cells", options.cells, TextForm{.form = "CELL,CELL...", .complaint = complaint_about_cells},
      "cells that get keys, separated by commas; none named: cell-1, and with renew those that have some");
  settings.add("days", options.days, {.min = 1, .max = 3650, .unit = "days"},
               "how long identities are valid");
  settings.add("check", options.check,
               "looks for what the middleware would fail on without a message; changes nothing");
  settings.add("renew", options.renew,
               "new identities and permissions from the authorities that are in the folder; an authority "
               "that would end "
               "before them is renewed, too");
}

}  // namespace
}  // namespace telekerf::security

int main(int argc, char** argv) {
  using namespace telekerf::security;
  return telekerf::run_program(argc, argv, "telekerf-keys",
                               "The keys of secured cells: who each process is, and what it may", Options{},
                               add_parameters, run);
}
