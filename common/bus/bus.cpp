// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus.h"

#include <fmt/format.h>

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
std::string Bus::unheard() const { return participant_->unheard(); }
std::string Bus::protection() const { return participant_->protection().sentence(); }
std::vector<std::string> Bus::dates() { return participant_->protection().dates(); }
bool Bus::lets_go() const noexcept { return participant_->protection().lets_go(); }
std::string Bus::ended() const { return participant_->protection().ended(); }
BusCounters Bus::counters() const { return participant_->counters(); }

// What a participant tells of its neighbours.

std::vector<PresenceMessage> Bus::Participant::others() const {
  const std::lock_guard lock(mutex_);
  std::vector<PresenceMessage> list;
  for (const auto& [key, other] : others_) list.push_back(other.presence);
  return list;
}

std::vector<Bus::Seen> Bus::Participant::seen() const {
  const std::lock_guard lock(mutex_);
  std::vector<Bus::Seen> list;
  for (const auto& [key, other] : others_) {
    const auto address = addresses_.find(key);
    list.push_back({other.presence, address == addresses_.end() ? "unknown" : address->second});
  }
  return list;
}

BusCounters Bus::Participant::counters() const {
  const std::lock_guard lock(mutex_);
  return {.incompatible = incompatible_.size(),
          .strangers = strangers_.size(),
          .refused = protection_.on() ? protection_.gate()->refused() : 0};
}

std::vector<std::string> Bus::Participant::strangers() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> sentences;
  for (const auto& [key, sentence] : strangers_) sentences.push_back(sentence);
  if (protection_.on() && protection_.gate()->refused() > 0)
    sentences.push_back(
        fmt::format("somebody without keys of cell '{}' sends to it, and is not let in", settings_.cell));
  if (protection_.on())
    if (std::string otherwise = protection_.otherwise(); !otherwise.empty())
      sentences.push_back(std::move(otherwise));
  return sentences;
}

std::string Bus::Participant::unheard() const {
  if (protection_.on()) return protection_.otherwise();
  const std::lock_guard lock(mutex_);
  if (with_keys_.empty()) return "";
  return fmt::format(
      "{} of domain {} with keys cannot be heard without: if this cell has some, give --security DIR",
      with_keys_.size() == 1 ? "a process" : "processes", settings_.domain);
}

std::optional<Bus::Rival> Bus::Participant::rival() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, other] : others_) {
    // This start's own participant of before a change of the network may not be forgotten yet.
    if (!other.presence.joined || other.presence.epoch == self_.presence.epoch) continue;
    if (auto reason = incompatibility(self_.presence, other.presence))
      return Rival{*reason, comes_second(self_, other)};
  }
  return std::nullopt;
}

std::vector<PresenceMessage> Bus::Participant::elsewhere() const {
  const std::lock_guard lock(mutex_);
  std::vector<PresenceMessage> list;
  for (const auto& [key, presence] : elsewhere_) list.push_back(presence);
  return list;
}

std::string Bus::Participant::stranger(const Key& key, const char* topic, const char* role) const {
  std::string who = "a participant that has not announced itself";
  if (const auto here = others_.find(key); here != others_.end()) {
    who = fmt::format("{} '{}'", here->second.presence.role, here->second.presence.name);
  } else if (const auto there = elsewhere_.find(key); there != elsewhere_.end()) {
    who = fmt::format("{} '{}' of cell '{}'", there->second.role, there->second.name, there->second.cell);
  }
  return fmt::format("what {} ({}) says on {} is not heard: it is no {} of cell '{}'", who, place(key), topic,
                     role == nullptr ? "process" : role, settings_.cell);
}

std::string Bus::Participant::unproven(const Key& key) const {
  const auto* const identity = protection_.identity(key);
  return fmt::format(
      "{} at {} says that it is of cell '{}', and does not prove it: both sides need keys of the same "
      "./telekerf keys that have not ended, and --wan on both sides or on neither",
      identity == nullptr ? "somebody" : identity->role, place(key), settings_.cell);
}

std::string Bus::Participant::place(const Key& key) const {
  const auto address = addresses_.find(key);
  return address == addresses_.end() ? "an unknown address" : address->second;
}

}  // namespace telekerf
