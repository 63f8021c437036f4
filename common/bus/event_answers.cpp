// SPDX-License-Identifier: Apache-2.0
#include "common/bus/event_answers.h"

namespace telekerf {
namespace {

constexpr std::chrono::milliseconds kAnswerAgain{300};
constexpr std::size_t kMostText = 256;
constexpr std::size_t kMostGiven = 64;

}  // namespace

void EventAnswers::give(std::uint32_t asker, const std::string& refusal) {
  EventMessage answer{.epoch = asker,
                      .kind = EventMessage::Kind::kAnswer,
                      .value = refusal.empty() ? 0.0 : 1.0,
                      .text = (role_ + ": " + (refusal.empty() ? "done" : refusal)).substr(0, kMostText)};
  const std::lock_guard lock(mutex_);
  (void)writer_.write(answer);
  if (given_.size() < kMostGiven) given_.push_back({std::move(answer), std::chrono::steady_clock::now()});
}

void EventAnswers::again() {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  std::erase_if(given_, [&](const Given& given) {
    if (now - given.when < kAnswerAgain) return false;
    (void)writer_.write(given.answer);
    return true;
  });
}

}  // namespace telekerf
