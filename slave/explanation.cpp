// SPDX-License-Identifier: Apache-2.0
#include "slave/explanation.h"

#include <fmt/format.h>

#include <string_view>

#include "common/protocol/sentences.h"

namespace telekerf::slave {

std::string beam_explanation(std::uint32_t forbidden, bool wanted, bool lit) {
  constexpr int kNamed = 2;  // the first of them: what comes after is mostly their consequence
  if (lit) return "beam on";
  std::string reasons;
  int count = 0;
  const auto add = [&](std::string_view reason) {
    if (++count > kNamed) return;
    if (!reasons.empty()) reasons += ", and ";
    reasons += reason;
  };
  for (std::size_t n = 0; n < laser::kGuardCount; ++n) {
    if ((forbidden >> n & 1U) != 0) add(laser::kGuards[n].sentence);
  }
  if (!wanted) add("nobody asks for it: no button, or the master does not pass it on");
  if (reasons.empty()) reasons = "its power is none";
  if (count > kNamed)
    reasons += fmt::format(" ({} reason{} more)", count - kNamed, count == kNamed + 1 ? "" : "s");
  return "beam off: " + reasons;
}

std::string tracking_explanation(SlaveMode mode, HoldReason reason, std::uint32_t forbidden, bool settled) {
  switch (mode) {
    case SlaveMode::kWaiting:
      return "not following: no master has engaged, or none is heard";
    case SlaveMode::kHolding:
      return std::string("not following, holding its place: ") + sentence_of(reason);
    case SlaveMode::kStopped:
      return "not following: the emergency stop is latched";
    case SlaveMode::kFollowing:
      break;
  }
  if ((forbidden & laser::guard_bit("sample")) != 0)
    return "not following: the command that is due, or a reading of the joints, has not come";
  return settled ? "following" : "following, still on its way to the master's motion";
}

std::string explanation(const SlaveOutputs& out) {
  if (out.mode == SlaveMode::kStopped) return "not following, beam off: the emergency stop is latched";
  return tracking_explanation(out.mode, out.reason, out.forbidden, out.settled) + "; " +
         beam_explanation(out.forbidden, out.button, out.laser_w > 0.0);
}

}  // namespace telekerf::slave
