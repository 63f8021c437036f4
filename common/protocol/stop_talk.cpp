// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/stop_talk.h"

#include <algorithm>
#include <random>

namespace telekerf {
namespace {

bool contains(const std::vector<std::uint32_t>& numbers, std::uint32_t number) {
  return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

/// Those that no entry has any more need not be remembered.
void keep_only(std::vector<std::uint32_t>& numbers, const std::vector<StopLatch::Entry>& entries) {
  std::erase_if(numbers, [&](std::uint32_t number) {
    return std::none_of(entries.begin(), entries.end(),
                        [&](const StopLatch::Entry& entry) { return entry.number == number; });
  });
}

}  // namespace

std::uint32_t any_stop_number() {
  std::random_device random;
  std::uint32_t number = 0;
  while (number == 0) number = random();
  return number;
}

void StopReplies::asked(const StopMessage& message) {
  if (!message.obeyed) std::erase(message.set ? told_set_ : told_cleared_, message.number);
}

StopMessage StopReplies::answer(const StopLatch::Entry& entry, bool set) const {
  return {.epoch = epoch_,
          .number = entry.number,
          .source = entry.source,
          .set = set,
          .obeyed = true,
          .reason = entry.reason};
}

std::vector<StopMessage> StopReplies::take(const StopLatch& latch, std::uint32_t obeyed) {
  std::vector<StopMessage> answers;
  keep_only(told_set_, latch.in_force());
  keep_only(told_cleared_, latch.cleared());
  for (const StopLatch::Entry& entry : latch.in_force()) {
    if (obeyed == 0 || entry.source.empty() || contains(told_set_, entry.number)) continue;
    answers.push_back(answer(entry, true));
    told_set_.push_back(entry.number);
  }
  for (const StopLatch::Entry& entry : latch.cleared()) {
    if (obeyed == entry.number || contains(told_cleared_, entry.number)) continue;
    answers.push_back(answer(entry, false));
    told_cleared_.push_back(entry.number);
  }
  return answers;
}

}  // namespace telekerf
