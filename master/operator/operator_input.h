// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the hand: who holds the laser button. The hand's force needs none, it acts on the
// robot.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace telekerf::master {

/// What a vendor implements (docs/attach-a-drive.md). It is entered in hand_input.cpp, and nowhere else.
class OperatorInput {
 public:
  virtual ~OperatorInput() = default;
  /// Once every control step. Neither allocates nor waits. Whoever is in doubt says no.
  virtual bool pressed(std::int64_t now_ns) noexcept = 0;
};

/// How a `button` may be written, one form after the other.
std::string button_forms();
/// What is wrong with a `button` as a user wrote it, and the remedy; empty: nothing.
std::string complaint_about_button(const std::string& button);
/// Null: the simulated hand's. Throws StartupError.
std::unique_ptr<OperatorInput> attach_button(const std::string& button);

}  // namespace telekerf::master
