// SPDX-License-Identifier: Apache-2.0
// Who may join a cell: one master, one slave, one vision; unique names; one version of the contract. Who has
// joined stays, whoever knocks. Pure rules; Bus applies them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/messages.h"

namespace telekerf {

/// A process that was seen, and the key that orders processes of the same epoch (its GUID prefix).
struct Neighbour {
  PresenceMessage presence;
  std::array<std::uint8_t, 12> key{};
};

/// Why the two cannot be in one cell, from the view of `self`: a sentence with its remedy. nullopt: they can.
std::optional<std::string> incompatibility(const PresenceMessage& self, const PresenceMessage& other);

/// Which of two that do not fit must give way. Who has joined stays; of two that both look around, the lower
/// epoch stays, then the lower key, so that exactly one of them does. Two that have both joined (they could
/// not see each other before) both stay.
bool must_give_way(const Neighbour& self, const Neighbour& other);

/// Of two that have both joined and do not fit, which one must give way if nothing else decides: the one with
/// the higher epoch, then the higher key, so that exactly one of them does.
bool comes_second(const Neighbour& self, const Neighbour& other);

}  // namespace telekerf
