// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the operator: a device that says when the laser is wanted, and, where it has one, the
// hand's force. A hand on a real master needs no device for its force: the robot feels it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/runtime/vectors.h"

namespace telekerf::master {

/// What the operator does at one control step.
struct OperatorSample {
  bool trigger = false;  ///< the laser is wanted
  /// Of the hand on the tool, N, master's workpiece frame; it moves a simulated master only. None: the device
  /// has no hand, and the simulated operator's moves the tool.
  std::optional<Vec3> force_n = {};
};

/// What a vendor implements. A device is its own files, with a function that opens it, and one row in
/// operator_input.cpp.
class OperatorInput {
 public:
  virtual ~OperatorInput() = default;
  /// Once every control step, `now_ns` on the monotonic clock. Neither allocates nor waits. Whoever is in
  /// doubt pulls no trigger.
  virtual OperatorSample sample(std::int64_t now_ns) noexcept = 0;
};

/// How the setting `button` may be written, one form after the other.
std::string operator_input_forms();
/// What is wrong with a `button` as a user wrote it, and the remedy; empty: nothing.
std::string validate_operator_input(const std::string& button);
/// Null ("hand"): the simulated operator's trigger. Throws StartupError.
std::unique_ptr<OperatorInput> open_operator_input(const std::string& button);

}  // namespace telekerf::master
