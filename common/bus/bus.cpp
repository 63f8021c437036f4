// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus.h"

#include <utility>

#include "common/bus/participant.h"

namespace telekerf {

std::string complaint_about_cell(const std::string& cell) {
  if (cell.empty()) return "a cell needs a name";
  // DDS takes a partition with one of these for a pattern: it would be every cell at once.
  if (cell.find_first_of("*?[]") != std::string::npos) return "a cell's name must hold none of * ? [ ]";
  return "";
}

Bus::Bus(BusSettings settings) : participant_(std::make_shared<Participant>(std::move(settings))) {
  participant_->join();
}
Bus::~Bus() = default;

const BusSettings& Bus::settings() const { return participant_->settings(); }
std::vector<PresenceMessage> Bus::others() const { return participant_->others(); }
std::vector<Bus::Seen> Bus::seen() const { return participant_->seen(); }
bool Bus::wait_for_role(const std::string& role, std::chrono::nanoseconds timeout) const {
  return participant_->wait_for_role(role, timeout);
}
const std::vector<std::string>& Bus::notes() const { return participant_->notes(); }
std::vector<std::string> Bus::strangers() const { return participant_->strangers(); }
std::optional<Bus::Rival> Bus::rival() const { return participant_->rival(); }
std::vector<PresenceMessage> Bus::elsewhere() const { return participant_->elsewhere(); }
std::string Bus::protection() const { return participant_->protection().sentence(); }
std::vector<std::string> Bus::dates() { return participant_->protection().dates(); }
bool Bus::lets_go() const noexcept { return participant_->protection().lets_go(); }
std::string Bus::ended() const { return participant_->protection().ended(); }
BusCounters Bus::counters() const { return participant_->counters(); }

}  // namespace telekerf
