// SPDX-License-Identifier: Apache-2.0
#include "common/bus/send_stop.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "common/bus/endpoints.h"
#include "common/bus/send_event.h"
#include "common/protocol/stop_talk.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{5};
/// Time to hear of the stops that the stations have latched.
constexpr std::chrono::milliseconds kListen{1500};

bool is_station(const PresenceMessage& process) {
  return process.role == "master" || process.role == "slave";
}

/// What the stations say of the stops that they obey.
class Answers {
 public:
  explicit Answers(Bus& bus) : reader_(bus, [this](const StopMessage& message) { hear(message); }) {}

  /// Of the stations that are there, those that have not said that this stop is in force (or over) for them.
  std::vector<std::string> missing(const Bus& bus, std::uint32_t number, bool set,
                                   std::vector<std::string>& told) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> missing;
    told.clear();
    for (const PresenceMessage& other : bus.others()) {
      if (!is_station(other)) continue;
      (said_.contains({other.epoch, number, set}) ? told : missing).push_back(other.name);
    }
    return missing;
  }
  std::vector<StopLatch::Entry> in_force() const {
    const std::lock_guard lock(mutex_);
    return latch_.in_force();
  }

 private:
  void hear(const StopMessage& message) {
    const std::lock_guard lock(mutex_);
    if (!message.obeyed) return;
    (void)latch_.hear(message);
    said_.insert({message.epoch, message.number, message.set});
  }

  mutable std::mutex mutex_;
  StopLatch latch_;
  std::set<std::tuple<std::uint32_t, std::uint32_t, bool>> said_;
  Reader<StopMessage> reader_;  ///< last: hears from its construction on
};

/// Says `message` again and again until every station has answered.
std::vector<std::string> insist(Bus& bus, const Answers& answers, const StopMessage& message) {
  Writer<StopMessage> writer(bus);
  std::vector<std::string> told, missing;
  const auto start = Clock::now();
  while (Clock::now() - start < kPatience) {
    if (!writer.write(message)) throw environment_error("the stop could not be sent");
    missing = answers.missing(bus, message.number, message.set, told);
    // Whoever is there shows up within the first announcements.
    const bool all_found = Clock::now() - start > std::chrono::milliseconds(600);
    if (missing.empty() && !told.empty() && all_found) return told;
    std::this_thread::sleep_for(kStopAgain);
  }
  if (told.empty() && missing.empty()) throw nobody_listens(bus);
  throw environment_error(
      fmt::format("{} of cell '{}' has not confirmed it within {} s{}: see to it at the machine",
                  fmt::join(missing, ", "), bus.settings().cell, kPatience.count(),
                  told.empty() ? std::string() : fmt::format(", {} has", fmt::join(told, ", "))));
}

}  // namespace

std::vector<std::string> send_stop(Bus& bus, const std::string& source, const std::string& reason) {
  const Answers answers(bus);
  std::random_device random;
  std::uint32_t number = 0;
  while (number == 0) number = random();
  return insist(bus, answers,
                {.epoch = bus.settings().epoch,
                 .number = number,
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
