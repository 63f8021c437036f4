// SPDX-License-Identifier: Apache-2.0
#include "common/bus/lookout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "common/bus/network_watch.h"

namespace telekerf {
namespace {

constexpr std::chrono::seconds kFirstWord{3};
constexpr std::chrono::seconds kNextWord{5};
/// Who has waited for a minute will wait for longer.
constexpr std::chrono::seconds kPatientAfter{60};

}  // namespace

std::string waiting_sentence(const Bus& bus, const std::string& what, const std::string& role) {
  std::vector<std::string> here, elsewhere;
  bool there = false;
  for (const PresenceMessage& other : bus.others()) {
    here.push_back(other.role);
    there = there || other.role == role;
  }
  constexpr std::size_t kMost = 3;
  for (const PresenceMessage& other : bus.elsewhere()) {
    if (other.role == role && elsewhere.size() < kMost)
      elsewhere.push_back(fmt::format("{} in cell '{}'", other.role, other.cell));
  }
  std::string sentence = fmt::format(
      "waiting for {}; seen in cell '{}' of domain {}: {}", what, bus.settings().cell, bus.settings().domain,
      here.empty() ? std::string("nobody") : fmt::format("{}", fmt::join(here, ", ")));
  if (!elsewhere.empty()) sentence += fmt::format("; elsewhere: {}", fmt::join(elsewhere, ", "));
  if (there) {
    sentence +=
        fmt::format("; what the {} sends does not arrive yet: does a firewall block UDP from port {} on?",
                    role, 7400 + 250 * bus.settings().domain);
  } else if (!elsewhere.empty()) {
    sentence += "; give both the same --cell";
  } else if (here.empty() && network_addresses().empty()) {
    sentence += "; this computer has no network: is its cable plugged in?";
  } else {
    sentence += fmt::format(
        "; is telekerf-{} running with this --cell and --domain? Where multicast does not reach it, name its "
        "computer: --peers HOST",
        role);
  }
  return sentence;
}

void Lookout::look_at_devices() {
  constexpr std::array<const char*, kDevices> kNames{"drive", "laser", "button", "hand"};
  constexpr std::uint64_t kMore = 10;
  for (std::size_t n = 0; n < kDevices; ++n) {
    const std::uint64_t refused = refused_[n].load(std::memory_order_relaxed);
    if (refused == 0 || refused < kMore * told_[n]) continue;
    told_[n] = refused;
    status_.say(fmt::format(
        "{0}: refused {1} {2} so far: another sender, another or no key, another length or version, or what "
        "is no number; who sends to it, and have both ends the same key and version?",
        kNames[n], refused, refused == 1 ? "datagram" : "datagrams"));
  }
}

void Lookout::look() {
  look_at_devices();
  for (const std::string& stranger : bus_.strangers()) {
    if (strangers_.insert(stranger).second) status_.say(stranger);
  }
  const Wish* const wish = wish_.load(std::memory_order_relaxed);
  const auto now = Clock::now();
  if (wish != said_) {
    said_ = wish;
    since_ = now;
    next_ = now + kFirstWord;
  }
  if (wish == nullptr || now < next_) return;
  status_.say(waiting_sentence(bus_, wish->what, wish->role));
  next_ = now + (now - since_ < kPatientAfter ? kNextWord : kPatientAfter);
}

}  // namespace telekerf
