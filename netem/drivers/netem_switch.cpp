// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/netem_switch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>

#include "common/protocol/network_choice.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "netem/core/profile.h"

namespace telekerf::netem {
namespace {

constexpr std::string_view kDecider = "slave";
constexpr std::uint32_t kNobody = 0;  ///< has asked
constexpr std::chrono::milliseconds kLook{50};
constexpr std::chrono::milliseconds kOnceMore{300};

bool someone_decides(const Bus& bus) {
  const auto others = bus.others();
  return std::any_of(others.begin(), others.end(), [](const auto& other) { return other.role == kDecider; });
}

}  // namespace

NetemSwitch::NetemSwitch(Bus& bus, std::shared_ptr<ReceivePathEmulator> emulator)
    : bus_(bus),
      decides_(bus.settings().role == kDecider),
      emulator_(std::move(emulator)),
      answers_(bus),
      events_(bus),
      decisions_(bus),
      hearing_(kLook, [this] { hear(); }) {}

void NetemSwitch::hear() {
  answers_.again();
  if (decides_) tell_newcomers();
  while (const auto event = events_.take()) {
    if (event->value.kind == EventMessage::Kind::kSetNetem) hear(event->value);
  }
}

void NetemSwitch::tell_newcomers() {
  const int readers = decisions_.readers();
  const bool more = readers > std::exchange(readers_, readers);
  if (profile_.empty()) return;
  const auto now = std::chrono::steady_clock::now();
  if (!more && now < again_at_) return;
  // Once more, as an answer is: who comes may find this process later than this process finds it.
  again_at_ = more ? now + kOnceMore : kNever;
  (void)decisions_.write(
      {.epoch = kNobody, .kind = EventMessage::Kind::kSetNetem, .value = kNetworkTaken, .text = profile_});
}

void NetemSwitch::hear(const EventMessage& event) {
  const bool asked = event.value == kNetworkAsked;
  if (asked && !decides_ && someone_decides(bus_)) return;  // its word comes
  if (!asked && decides_) return;
  if (!asked && event.value == kNetworkTaken) {
    const bool known = std::exchange(decided_, event.text) == event.text;
    if (known && event.epoch == kNobody) return;  // it was for somebody who came later
  }
  const Verdict verdict = event.value == kNetworkRefused
                              ? Verdict{Outcome::kRefusedBySlave, std::string(kAsAtTheSlave)}
                              : switch_to(event.text);
  const bool switched = verdict.outcome == Outcome::kSwitched;
  ++counts_[static_cast<std::size_t>(verdict.outcome)];
  if (decides_) {
    (void)decisions_.write({.epoch = event.epoch,
                            .kind = EventMessage::Kind::kSetNetem,
                            .value = switched ? kNetworkTaken : kNetworkRefused,
                            .text = event.text});
  }
  const std::string refusal = switched ? "" : fmt::format("the network stays as it is: {}", verdict.text);
  const std::string& role = bus_.settings().role;
  if (switched)
    write_line(stdout, fmt::format("{}: the network is now '{}'{}{}", role, event.text,
                                   verdict.text.empty() ? "" : "; ", verdict.text));
  else
    write_line(stderr, fmt::format("{}: {}", role, refusal));
  if (event.epoch != kNobody) answers_.give(event.epoch, refusal);
}

NetemSwitch::Verdict NetemSwitch::switch_to(const std::string& profile) {
  try {
    const Profile fresh = load_profile(profile);
    if (!emulator_)
      return {Outcome::kNotEmulated, "this process runs without an emulated network; start it with --netem"};
    if (beam_.load(std::memory_order_relaxed)) {
      if (profile == profile_) return {};  // who asks says it more than once
      return {Outcome::kBeamOn, "not while the beam is on; disengage first (telekerf-ctl disengage)"};
    }
    emulator_->set_profile(fresh);
    profile_ = profile;
    return {Outcome::kSwitched, trace_note(fresh)};
  } catch (const StartupError& refusal) {
    return {Outcome::kUnreadable, refusal.what()};
  }
}

void NetemSwitch::add_figures(Metrics& figures) const {
  constexpr std::array<const char*, kOutcomes> kNames{"netem_switched", "netem_refused_beam_on",
                                                      "netem_refused_not_emulated", "netem_refused_unreadable",
                                                      "netem_refused_by_slave"};
  for (std::size_t n = 0; n < kOutcomes; ++n)
    figures[kNames[n]] = static_cast<double>(counts_[n].load(std::memory_order_relaxed));
}

}  // namespace telekerf::netem
