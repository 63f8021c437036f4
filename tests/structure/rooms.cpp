// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/rooms.h"

#include <sstream>
#include <stdexcept>

#include "tests/structure/repository.h"

namespace telekerf::structure {

Rooms::Rooms(std::string_view table) {
  for (const std::string& line : lines_of(table)) {
    if (line.empty() || line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string room, colon;
    if (!(words >> room >> colon) || colon != ":" || rows_.contains(room))
      throw std::runtime_error("no row, or a second one: " + line);
    auto& row = rows_[room];
    for (std::string below; words >> below;) row.insert(below);
  }
  for (const auto& [room, row] : rows_)
    for (const std::string& below : row)
      if (!rows_.contains(below)) throw std::runtime_error(room + " names " + below + ", which has no row");
  if (const std::string cycle = cycle_in(rows_); !cycle.empty()) throw std::runtime_error("cycle: " + cycle);
}

std::string Rooms::room_of(const std::string& path) const {
  for (std::string room = path; !room.empty(); room = folder_of(room))
    if (rows_.contains(room)) return room;
  return "";
}

bool Rooms::allows(const std::string& from, const std::string& to) const {
  if (from == to) return true;
  const auto row = rows_.find(from);
  if (row == rows_.end()) return false;
  for (const std::string& below : row->second)
    if (allows(below, to)) return true;
  return false;
}

}  // namespace telekerf::structure
