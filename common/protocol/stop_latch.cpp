// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/stop_latch.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace telekerf {
namespace {

auto find(std::vector<StopLatch::Entry>& entries, std::uint32_t number) {
  return std::find_if(entries.begin(), entries.end(),
                      [&](const StopLatch::Entry& entry) { return entry.number == number; });
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return text;
}

}  // namespace

bool StopLatch::was_cleared(std::uint32_t number) const noexcept {
  return std::any_of(cleared_.begin(), cleared_.end(),
                     [&](const Entry& entry) { return entry.number == number; });
}

StopLatch::Heard StopLatch::hear(const StopMessage& message) {
  if (message.number == 0) return Heard::kKnown;
  const auto entry = find(in_force_, message.number);
  if (message.set) {
    if (was_cleared(message.number)) return Heard::kKnown;
    if (entry != in_force_.end()) {
      if (entry->source.empty()) *entry = {message.number, message.source, message.reason};
      return Heard::kKnown;
    }
    if (in_force_.size() == kMost) return Heard::kKnown;  // stopped as it is
    in_force_.push_back({message.number, message.source, message.reason});
    return Heard::kStopped;
  }
  if (was_cleared(message.number)) return Heard::kKnown;
  const bool there = entry != in_force_.end();
  // Of a stop whose owner has not been heard yet, a station that knew the owner may say that it is over.
  const bool allowed = there && (entry->source.empty() ? message.obeyed : entry->source == message.source);
  if (there && !allowed) return Heard::kRefused;
  if (!there && message.source.empty()) return Heard::kRefused;
  if (there) in_force_.erase(entry);
  if (cleared_.size() == kMost) cleared_.erase(cleared_.begin());
  cleared_.push_back({message.number, message.source, message.reason});
  return there ? Heard::kCleared : Heard::kKnown;
}

StopLatch::Heard StopLatch::quoted(std::uint32_t number) {
  return hear({.number = number, .source = {}, .reason = {}});
}

StopOrder StopLatch::order() const noexcept {
  StopOrder order{.number = in_force_.empty() ? 0 : in_force_.back().number, .cleared = {}};
  for (std::size_t n = 0; n < std::min(order.cleared.size(), cleared_.size()); ++n)
    order.cleared[n] = cleared_[cleared_.size() - 1 - n].number;
  return order;
}

std::string StopLatch::text() const {
  std::string text;
  for (const Entry& entry : in_force_)
    text += fmt::format("{}\t{}\t{}\n", entry.number, one_line(entry.source), one_line(entry.reason));
  return text;
}

StopLatch StopLatch::from_text(const std::string& text) {
  StopLatch latch;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string number, source, reason;
    std::getline(words, number, '\t');
    std::getline(words, source, '\t');
    std::getline(words, reason);
    if (number.empty() || number.size() > 10 || !std::all_of(number.begin(), number.end(), ::isdigit))
      continue;
    const unsigned long long value = std::stoull(number);
    if (value == 0 || value > 0xFFFFFFFFULL) continue;
    (void)latch.hear({.number = static_cast<std::uint32_t>(value), .source = source, .reason = reason});
  }
  return latch;
}

}  // namespace telekerf
