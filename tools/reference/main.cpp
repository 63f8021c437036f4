// SPDX-License-Identifier: Apache-2.0
// telekerf-reference: writes the pages and the completion script that come from declarations, never from a
// hand: docs/reference/settings.md, docs/reference/records.md, tools/reference/telekerf.bash; for packages
// manual pages and the file of a cell's settings.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/runtime/program.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/reference/bash_completion.h"
#include "tools/reference/cell_file.h"
#include "tools/reference/man_page.h"
#include "tools/reference/records_page.h"
#include "tools/reference/settings_page.h"

namespace telekerf::reference {
namespace {

constexpr std::array kPrograms{"telekerf-master",     "telekerf-slave",   "telekerf-machine",
                               "telekerf-vision",     "telekerf-console", "telekerf-ctl",
                               "telekerf-netem",      "telekerf-robot",   "telekerf-plant",
                               "telekerf-experiment", "telekerf-inspect", "telekerf-keys"};

struct Options {
  std::string programs;
  std::string out = ".";
  std::string package;
};

nlohmann::ordered_json description_of(const std::filesystem::path& program) {
  const std::string command = fmt::format("'{}' --describe-settings", program.string());
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe.get()) != nullptr) text += part.data();
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!json.is_object())
    throw environment_error(
        fmt::format("{}: does not describe itself; is everything built?", program.string()));
  return json;
}

/// Of the programs that are built.
int write_package(const Options& options) {
  nlohmann::ordered_json programs;
  for (const char* name : kPrograms) {
    const auto program = std::filesystem::path(options.programs) / name;
    if (std::filesystem::exists(program)) programs.push_back(description_of(program));
  }
  const std::filesystem::path out = options.package;
  for (const auto& program : programs)
    write_atomically(out / (program["program"].get<std::string>() + ".1"), man_page(program));
  write_atomically(out / "cell-1.toml", cell_file(programs));
  return 0;
}

int run(const Options& options) {
  if (!options.package.empty()) return write_package(options);
  nlohmann::ordered_json programs;
  for (const char* name : kPrograms)
    programs.push_back(description_of(std::filesystem::path(options.programs) / name));
  const std::filesystem::path out = options.out;
  write_atomically(out / "docs/reference/settings.md", settings_page(programs));
  write_atomically(out / "docs/reference/records.md", records_page());
  write_atomically(out / "tools/reference/telekerf.bash", bash_completion(programs));
  return 0;
}

void add_parameters(Options& options, Settings& settings) {
  settings.add("programs", options.programs, kFolder, "that holds them all, e.g. build/bin").as_argument();
  settings.add("out", options.out, kFolder, "the project's own, or another to compare with it");
  settings.add("package", options.package, kFolder,
               "writes manual pages and the file of a cell's settings there instead");
}

}  // namespace
}  // namespace telekerf::reference

int main(int argc, char** argv) {
  using namespace telekerf::reference;
  return telekerf::run_program(argc, argv, "telekerf-reference",
                               "Writes the reference pages and the completion script from the declarations",
                               Options{}, add_parameters, run);
}
