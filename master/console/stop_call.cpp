// SPDX-License-Identifier: Apache-2.0
#include "master/console/stop_call.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace telekerf::master {
namespace {

constexpr std::int64_t kAgain_ns = 20'000'000;
/// A stop is said for at least so long, as stations may be on their way to be found; a station that does not
/// answer is called for so long and no longer.
constexpr std::int64_t kAtLeast_ns = 600'000'000;
constexpr std::int64_t kPatience_ns = 5'000'000'000;

}  // namespace

void StopCall::stop(std::uint32_t number, const std::string& reason, std::int64_t now_ns) {
  if (saying_stop()) return;
  said_ = StopMessage{
      .epoch = epoch_, .number = number, .source = source_, .set = true, .obeyed = false, .reason = reason};
  since_ns_ = again_ns_ = now_ns;
  missing_.clear();
}

std::string StopCall::clear(std::int64_t now_ns) {
  if (saying_stop()) return "The stop has not been obeyed by everyone yet";
  if (answers_.in_force().empty()) return "No stop is in force";
  for (const StopLatch::Entry& stop : answers_.in_force()) {
    if (stop.source != source_) continue;
    said_ = StopMessage{.epoch = epoch_,
                        .number = stop.number,
                        .source = source_,
                        .set = false,
                        .obeyed = false,
                        .reason = {}};
    since_ns_ = again_ns_ = now_ns;
    return "";
  }
  return fmt::format("The stop was said by {}, and nobody else clears it", answers_.in_force().back().source);
}

std::optional<StopMessage> StopCall::step(std::span<const PresenceMessage> others, std::int64_t now_ns) {
  if (!due(now_ns)) return std::nullopt;
  std::vector<std::string> told;
  const std::vector<std::string> missing = answers_.missing(others, said_->number, said_->set, told);
  const bool done = missing.empty() && !told.empty() && now_ns - since_ns_ > kAtLeast_ns;
  if (done || now_ns - since_ns_ > kPatience_ns) {
    missing_ = fmt::format("{}", fmt::join(missing, ", "));
    said_.reset();
    return std::nullopt;
  }
  again_ns_ = now_ns + kAgain_ns;
  return said_;
}

std::string StopCall::sentence() const {
  if (saying_stop()) return fmt::format("Stopping: {}", said_->reason);
  if (!missing_.empty())
    return fmt::format("The stop was not confirmed by {}: see to it at the machine", missing_);
  if (answers_.in_force().empty()) return "";
  const StopLatch::Entry& stop = answers_.in_force().back();
  return fmt::format("Stopped by {}{}{}", stop.source.empty() ? "somebody" : stop.source,
                     stop.reason.empty() ? "" : ": ", stop.reason);
}

}  // namespace telekerf::master
