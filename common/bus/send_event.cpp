// SPDX-License-Identifier: Apache-2.0
#include "common/bus/send_event.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "common/bus/endpoints.h"

namespace telekerf {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kAnswered{5};

/// Role -> its answer.
class Answered {
 public:
  explicit Answered(Bus& bus)
      : epoch_(bus.settings().epoch), reader_(bus, [this](const EventMessage& event) { hear(event); }) {}

  std::map<std::string, EventMessage> all() const {
    const std::lock_guard lock(mutex_);
    return answers_;
  }
  int writers() const { return reader_.writers(); }

 private:
  void hear(const EventMessage& event) {
    if (event.kind != EventMessage::Kind::kAnswer || event.epoch != epoch_) return;
    const std::lock_guard lock(mutex_);
    answers_.emplace(event.text.substr(0, event.text.find(':')), event);
  }

  std::uint32_t epoch_;
  mutable std::mutex mutex_;
  std::map<std::string, EventMessage> answers_;
  Reader<EventMessage> reader_;  ///< last: hears from its construction on
};

std::vector<std::string> present(const Bus& bus, const std::vector<std::string>& roles) {
  std::vector<std::string> there;
  for (const PresenceMessage& other : bus.others()) {
    if (std::find(roles.begin(), roles.end(), other.role) != roles.end()) there.push_back(other.role);
  }
  return there;
}

}  // namespace

StartupError nobody_listens(const Bus& bus) {
  if (const std::string unheard = bus.unheard(); !unheard.empty())
    return environment_error(fmt::format("nobody listens in cell '{}' of domain {}: {}", bus.settings().cell,
                                         bus.settings().domain, unheard));
  return environment_error(
      fmt::format("nobody listens in cell '{}' of domain {}: start its processes first, or give their --cell "
                  "and --domain{}",
                  bus.settings().cell, bus.settings().domain,
                  bus.settings().security.empty() ? ", and --security DIR if they have keys" : ""));
}

std::vector<std::string> tell(Bus& bus, EventMessage event, const std::vector<std::string>& roles) {
  const Answered answered(bus);
  Writer<EventMessage> writer(bus);
  // A computer that has much to do, or a long way, takes its time until those that are there are found.
  std::vector<std::string> asked = present(bus, roles);
  for (const auto begun = Clock::now(); asked.empty() && Clock::now() - begun < kAnswered;
       asked = present(bus, roles))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (bus.others().empty()) throw nobody_listens(bus);
  if (asked.empty())
    throw environment_error(fmt::format("there is no {} in cell '{}' of domain {} to do it",
                                        fmt::join(roles, " or "), bus.settings().cell,
                                        bus.settings().domain));
  if (!writer.wait_for_reader(kAnswered)) throw nobody_listens(bus);
  event.epoch = bus.settings().epoch;
  const auto start = Clock::now();
  std::vector<std::string> done, refusals, silent;
  for (int told = 0; Clock::now() - start < kAnswered;) {
    // Who is there hears it at once, the rest as soon as they are found.
    if (const int readers = writer.readers(); readers > told) {
      if (!writer.write(event)) throw environment_error("the event could not be sent");
      told = readers;
    }
    const auto answers = answered.all();
    done.clear();
    refusals.clear();
    silent.clear();
    for (const std::string& role : asked) {
      const auto answer = answers.find(role);
      if (answer == answers.end()) {
        silent.push_back(role);
      } else if (answer->second.value == 0.0) {
        done.push_back(role);
      } else {
        refusals.push_back(answer->second.text);
      }
    }
    if (silent.empty()) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const char* const did = event.kind == EventMessage::Kind::kTakeContour
                              ? "; {}, which had taken it, goes back to the one before"  // ContourSubscriber
                              : "; done by {}";
  const std::string but = done.empty() ? "" : fmt::format(fmt::runtime(did), fmt::join(done, ", "));
  if (!refusals.empty()) throw environment_error(fmt::format("{}{}", fmt::join(refusals, "; "), but));
  if (!silent.empty())
    throw environment_error(
        fmt::format("{} of cell '{}' has not answered within {} s{}: see to it at the machine",
                    fmt::join(silent, ", "), bus.settings().cell, kAnswered.count(), but));
  return done;
}

}  // namespace telekerf
