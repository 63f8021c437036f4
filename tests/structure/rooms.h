// SPDX-License-Identifier: Apache-2.0
// The table of rooms: who may include whom.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace telekerf::structure {

class Rooms {
 public:
  /// Lines of `room : room room ...`; `#` begins a comment. Throws std::runtime_error on anything else.
  explicit Rooms(std::string_view table);

  /// The longest row that is the file or a folder above it; empty if there is none.
  std::string room_of(const std::string& path) const;
  /// Is `to` in the row of `from`, or in a row that this one names, and so on?
  bool allows(const std::string& from, const std::string& to) const;

  const std::map<std::string, std::set<std::string>>& rows() const { return rows_; }

 private:
  std::map<std::string, std::set<std::string>> rows_;
};

}  // namespace telekerf::structure
