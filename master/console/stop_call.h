// SPDX-License-Identifier: Apache-2.0
// The page's stop: said at once, and again until every station has obeyed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/protocol/stop_answers.h"

namespace telekerf::master {

/// Pure: time is what it is told, and what is to be said is returned.
class StopCall {
 public:
  /// `source`: who stops; nobody else clears these stops. `epoch`: of this process.
  StopCall(std::string source, std::uint32_t epoch) : source_(std::move(source)), epoch_(epoch) {}

  /// `number`: of the stop, not 0 and by nobody used before.
  void stop(std::uint32_t number, const std::string& reason, std::int64_t now_ns);
  /// Ends the stops that `source` has said. Why nothing comes of it; empty: it is being said.
  std::string clear(std::int64_t now_ns);
  void hear(const StopMessage& message) { answers_.hear(message); }

  /// Something is to be said again and again.
  bool says() const noexcept { return said_.has_value(); }
  /// It is to be said now.
  bool due(std::int64_t now_ns) const noexcept { return said_ && now_ns >= again_ns_; }
  /// What is to be said now: call it as soon as it is due. `others`: everyone in the cell.
  std::optional<StopMessage> step(std::span<const PresenceMessage> others, std::int64_t now_ns);

  /// "" while nothing is stopped.
  std::string sentence() const;
  bool in_force() const { return saying_stop() || !answers_.in_force().empty(); }

 private:
  bool saying_stop() const { return said_ && said_->set; }

  std::string source_;
  std::uint32_t epoch_;
  StopAnswers answers_;
  std::optional<StopMessage> said_;  ///< what is being said
  std::int64_t since_ns_ = 0;        ///< when it was said first,
  std::int64_t again_ns_ = 0;        ///< and when it is due again
  std::string missing_;              ///< stations that have not answered
};

}  // namespace telekerf::master
