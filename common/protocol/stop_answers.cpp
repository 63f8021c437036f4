// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/stop_answers.h"

namespace telekerf {

bool is_station(const PresenceMessage& process) {
  return process.role == "master" || process.role == "slave";
}

void StopAnswers::hear(const StopMessage& message) {
  if (!message.obeyed) return;
  (void)latch_.hear(message);
  said_.insert({message.epoch, message.number, message.set});
}

std::vector<std::string> StopAnswers::missing(std::span<const PresenceMessage> others, std::uint32_t number,
                                              bool set, std::vector<std::string>& told) const {
  std::vector<std::string> missing;
  told.clear();
  for (const PresenceMessage& other : others) {
    if (!is_station(other)) continue;
    (said(other, number, set) ? told : missing).push_back(other.name);
  }
  return missing;
}

}  // namespace telekerf
