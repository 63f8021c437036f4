// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/netem_switch.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "netem/core/profile.h"

namespace telekerf::netem {

NetemSwitch::NetemSwitch(Bus& bus, std::shared_ptr<ReceivePathEmulator> emulator)
    : role_(bus.settings().role),
      emulator_(std::move(emulator)),
      answers_(bus),
      events_(bus),
      hearing_(std::chrono::milliseconds(20), [this] { hear(); }) {}

void NetemSwitch::hear() {
  answers_.again();
  while (const auto event = events_.take()) {
    if (event->value.kind != EventMessage::Kind::kSetNetem) continue;
    try {
      const std::string note = switch_to(event->value.text);
      write_line(stdout, fmt::format("{}: the network is now '{}'{}{}", role_, event->value.text,
                                     note.empty() ? "" : "; ", note));
      answers_.give(event->value.epoch, "");
    } catch (const StartupError& refusal) {
      write_line(stderr, fmt::format("{}: the network stays as it is: {}", role_, refusal.what()));
      answers_.give(event->value.epoch, fmt::format("the network stays as it is: {}", refusal.what()));
    }
  }
}

std::string NetemSwitch::switch_to(const std::string& profile) {
  const Profile fresh = load_profile(profile);
  if (!emulator_)
    throw environment_error("this process runs without an emulated network; start it with --netem");
  if (beam_.load(std::memory_order_relaxed))
    throw environment_error("not while the beam is on; disengage first (telekerf-ctl disengage)");
  emulator_->set_profile(fresh);
  return trace_note(fresh);
}

}  // namespace telekerf::netem
