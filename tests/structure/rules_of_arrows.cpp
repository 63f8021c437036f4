// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

using Arrows = std::map<std::string, std::set<std::string>>;

std::vector<Include> all_includes(const Repository& repository) {
  std::vector<Include> all;
  for (const auto& [path, text] : repository.files) {
    if (!is_source(path)) continue;
    for (Include& include : includes_of(repository, path)) all.push_back(std::move(include));
  }
  return all;
}

}  // namespace

Breaches upward_arrows(const Repository& repository, const Rooms& rooms) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files)
    if (is_source(path) && rooms.room_of(path).empty())
      breaches.push_back(path + " lies in no room of the table");
  for (const Include& include : all_includes(repository)) {
    const std::string from = rooms.room_of(include.from), to = rooms.room_of(include.to);
    if (!rooms.allows(from, to)) breaches.push_back(include.from + " includes " + include.to);
  }
  return breaches;
}

Breaches include_cycles(const Repository& repository, const Rooms& rooms) {
  Arrows files, between_rooms;
  for (const Include& include : all_includes(repository)) {
    files[include.from].insert(include.to);
    const std::string from = rooms.room_of(include.from), to = rooms.room_of(include.to);
    if (from != to) between_rooms[from].insert(to);
  }
  Breaches breaches;
  for (const Arrows* arrows : {&files, &between_rooms})
    if (const std::string cycle = cycle_in(*arrows); !cycle.empty()) breaches.push_back(cycle);
  return breaches;
}

Breaches programs_in_common(const Repository& repository) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    if (!path.starts_with("common/")) continue;
    const bool built = path.ends_with("CMakeLists.txt") && (text.find("telekerf_program(") != text.npos ||
                                                            text.find("add_executable(") != text.npos);
    if (built || is_program(text)) breaches.push_back(path + " makes a program");
  }
  return breaches;
}

Breaches strayed_dds(const Repository& repository) {
  Breaches breaches;
  std::set<std::string> drivers;
  for (const auto& [path, text] : repository.files) {
    if (!is_source(path) || path.starts_with("common/bus/") || path.starts_with("tests/")) continue;
    bool knows = false;
    for (const std::string& line : lines_of(text))
      knows = knows || line.starts_with("#include <fast") || line.starts_with("#include \"fast");
    if (!knows) continue;
    if (path.starts_with("netem/drivers/"))
      drivers.insert(path.substr(0, path.rfind('.')));
    else
      breaches.push_back(path + " includes Fast DDS");
  }
  if (drivers.size() > 1)
    breaches.push_back(*drivers.begin() + " and " + *drivers.rbegin() + " include Fast DDS");
  return breaches;
}

}  // namespace telekerf::structure
