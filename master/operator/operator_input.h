// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the operator: a device that says whether a hand is there, where it pulls or how hard,
// and when the laser is wanted. A hand on a real master needs no device for its force: the robot feels it.
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
  bool held = false;     ///< a hand is there, and holds the tool
  bool stop = false;     ///< an emergency stop is wanted
  /// Of the hand on the tool, N, master's workpiece frame; it moves a simulated master only. None: the device
  /// knows no force.
  std::optional<Vec3> force_n = {};
  /// Where the hand pulls the tool, m, on the contour as it was published; the arm between them (arm.h) makes
  /// a force of it. None: it pulls nothing.
  std::optional<Vec2> pointer_m = {};
};

/// What became of it in the same step, for devices that show or return it.
struct OperatorAnswer {
  std::int64_t now_ns = 0;
  bool guided = false;          ///< the constraint holds the tool
  Vec2 tool_m = Vec2::Zero();   ///< on the contour as it was published
  Vec2 force_n = Vec2::Zero();  ///< of the hand on the tool, master's workpiece frame
};

/// What a vendor implements. A device is its own files, with a function that opens it, and one row in
/// operator_input.cpp.
class OperatorInput {
 public:
  virtual ~OperatorInput() = default;
  /// Once every control step, `now_ns` on the monotonic clock. Neither allocates nor waits. Whoever is in
  /// doubt pulls no trigger and holds nothing.
  virtual OperatorSample sample(std::int64_t now_ns) noexcept = 0;
  /// At the end of the same step. Neither allocates nor waits.
  virtual void answer(const OperatorAnswer& /*answer*/) noexcept {}
  /// What has come under its address and was not of it, so that nothing was made of it.
  virtual std::uint64_t refused() const noexcept { return 0; }
};

/// How the setting `button` may be written, one form after the other; what is wrong with one as a user wrote
/// it, and the remedy (empty: nothing); and the device. Null ("hand"): the hand's own trigger. Throws
/// StartupError.
std::string operator_input_forms();
std::string validate_operator_input(const std::string& button);
std::unique_ptr<OperatorInput> open_operator_input(const std::string& button);

struct SpaceMouseSettings;

/// The same of the setting `hand`; `cap`: of a SpaceMouse. Null: the simulated operator.
std::string hand_forms();
std::string validate_hand(const std::string& hand);
std::unique_ptr<OperatorInput> open_hand(const std::string& hand, const SpaceMouseSettings& cap);

}  // namespace telekerf::master
