// SPDX-License-Identifier: Apache-2.0
#include "common/bus/send_stop.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "common/bus/endpoints.h"
#include "common/bus/send_event.h"
#include "common/protocol/stop_answers.h"
#include "common/protocol/stop_talk.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kAllFound{600};
/// Time to hear of the stops that the stations have latched.
constexpr std::chrono::milliseconds kListen{1500};

/// As people know it: by its role, and by its name where that is another.
std::string title(const PresenceMessage& process) {
  return process.name == process.role ? process.role : process.role + " '" + process.name + "'";
}

struct Confirmations {
  std::vector<std::string> told, missing;
  bool master = false, slave = false;  ///< have confirmed it; a machine is a slave
};

/// What the stations say of the stops that they obey, heard in the middleware's thread.
class Answers {
 public:
  explicit Answers(Bus& bus)
      : reader_(bus, [this](const StopMessage& message) {
          const std::lock_guard lock(mutex_);
          answers_.hear(message);
        }) {}

  /// Which of the stations that are there have said that this stop is in force (or over) for them.
  Confirmations of(const Bus& bus, std::uint32_t number, bool set) const {
    const std::lock_guard lock(mutex_);
    Confirmations now;
    for (const PresenceMessage& other : bus.others()) {
      if (!is_station(other)) continue;
      const bool said = answers_.said(other, number, set);
      (said ? now.told : now.missing).push_back(title(other));
      if (said) (other.role == "master" ? now.master : now.slave) = true;
    }
    return now;
  }
  std::vector<StopLatch::Entry> in_force() const {
    const std::lock_guard lock(mutex_);
    return answers_.in_force();
  }

 private:
  mutable std::mutex mutex_;
  StopAnswers answers_;
  Reader<StopMessage> reader_;  ///< last: hears from its construction on
};

/// Says `message` again and again until every station has answered.
std::vector<std::string> insist(Bus& bus, const Answers& answers, const StopMessage& message) {
  Writer<StopMessage> writer(bus);
  Confirmations now;
  const auto start = Clock::now();
  while (Clock::now() - start < kPatience) {
    if (!writer.write(message)) throw environment_error("the stop could not be sent");
    for (const auto next = Clock::now() + kStopAgain; Clock::now() < next;) {
      now = answers.of(bus, message.number, message.set);
      // A cell has one of each. Whoever is there beside one alone shows up within the first announcements.
      const bool all_found = (now.master && now.slave) || Clock::now() - start > kAllFound;
      const bool where_it_matters = now.slave || (!message.set && now.master);
      if (now.missing.empty() && all_found && where_it_matters) return now.told;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  const std::string place = fmt::format("cell '{}' of domain {}", bus.settings().cell, bus.settings().domain);
  if (now.told.empty() && now.missing.empty()) throw nobody_listens(bus);
  if (now.missing.empty()) {
    const std::string unheard = bus.unheard();
    throw environment_error(fmt::format(
        "{} has confirmed it, but no slave is seen in {}: see to it at the machine; a slave that comes back "
        "hears of it{}{}",
        fmt::join(now.told, ", "), place, unheard.empty() ? "" : "; ", unheard));
  }
  throw environment_error(
      fmt::format("{} of {} has not confirmed it within {} s{}: see to it at the machine",
                  fmt::join(now.missing, ", "), place, kPatience.count(),
                  now.told.empty() ? std::string() : fmt::format(", {} has", fmt::join(now.told, ", "))));
}

}  // namespace

std::vector<std::string> send_stop(Bus& bus, const std::string& source, const std::string& reason) {
  const Answers answers(bus);
  return insist(bus, answers,
                {.epoch = bus.settings().epoch,
                 .number = any_stop_number(),
                 .source = source,
                 .set = true,
                 .obeyed = false,
                 .reason = reason});
}

std::vector<std::string> clear_stop(Bus& bus, const std::string& source) {
  const Answers answers(bus);
  std::this_thread::sleep_for(kListen);
  const std::vector<StopLatch::Entry> stops = answers.in_force();
  std::vector<std::string> told;
  if (stops.empty()) {
    bool anyone = false;
    for (const PresenceMessage& other : bus.others()) anyone = anyone || is_station(other);
    if (!anyone) throw nobody_listens(bus);
    throw usage_error(fmt::format("no stop is in force in cell '{}'", bus.settings().cell));
  }
  bool cleared = false;
  for (const StopLatch::Entry& stop : stops) {
    if (stop.source != source) continue;
    told = insist(bus, answers,
                  {.epoch = bus.settings().epoch,
                   .number = stop.number,
                   .source = source,
                   .set = false,
                   .obeyed = false,
                   .reason = {}});
    cleared = true;
  }
  if (!cleared)
    throw usage_error(fmt::format("the stop was said by {}, and nobody else clears it: --as {}",
                                  stops.back().source, stops.back().source));
  return told;
}

}  // namespace telekerf
