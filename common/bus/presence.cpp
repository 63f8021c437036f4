// SPDX-License-Identifier: Apache-2.0
#include "common/bus/presence.h"

#include <fmt/format.h>

#include <tuple>

namespace telekerf {
namespace {

bool one_per_cell(const std::string& role) { return role == "master" || role == "slave" || role == "vision"; }

}  // namespace

std::optional<std::string> incompatibility(const PresenceMessage& self, const PresenceMessage& other) {
  if (self.cell != other.cell) return std::nullopt;
  if (self.contract != other.contract) {
    return fmt::format(
        "{} '{}' in cell '{}' speaks contract {} and this {} speaks contract {}: install the same version on "
        "both "
        "machines",
        other.role, other.name, other.cell, other.contract, self.role, self.contract);
  }
  if (self.role == other.role && one_per_cell(self.role)) {
    return fmt::format("a second {} in cell '{}': '{}' already runs there; stop it, or choose another --cell",
                       self.role, self.cell, other.name);
  }
  if (self.name == other.name) {
    return fmt::format("the name '{}' is taken in cell '{}' by a {}; choose another --name", self.name,
                       self.cell, other.role);
  }
  return std::nullopt;
}

bool must_give_way(const Neighbour& self, const Neighbour& other) {
  if (self.presence.joined) return false;
  return other.presence.joined || comes_second(self, other);
}

bool comes_second(const Neighbour& self, const Neighbour& other) {
  return std::tie(other.presence.epoch, other.key) < std::tie(self.presence.epoch, self.key);
}

}  // namespace telekerf
