// SPDX-License-Identifier: Apache-2.0
// What is said of an emulated network in a running cell (EventMessage::Kind::kSetNetem). The slave, which has the beam,
// decides for everyone and says so by the same event, with the epoch of who has asked; to
// who comes later once more, with the epoch 0.
#pragma once

#include <string_view>

namespace telekerf {

/// The event's value: somebody asks; the slave has taken it, or has refused it.
inline constexpr double kNetworkAsked = 0.0, kNetworkTaken = 1.0, kNetworkRefused = 2.0;
/// How the others' answers end where the slave has refused: its own answer says why.
inline constexpr std::string_view kAsAtTheSlave = "as at the slave";

}  // namespace telekerf
