// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/netem_switch.h"

#include <fmt/format.h>

#include <cstdio>

#include "common/runtime/startup_error.h"
#include "netem/core/profile.h"

namespace telekerf::netem {

void NetemSwitch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    while (const auto event = events_.take()) {
      if (event->value.kind != EventMessage::Kind::kSetNetem) continue;
      try {
        const std::string note = switch_to(event->value.text);
        fmt::print("{}: the network is now '{}'{}{}\n", role_, event->value.text, note.empty() ? "" : "; ",
                   note);
        std::fflush(stdout);
      } catch (const StartupError& refusal) {
        fmt::print(stderr, "{}: the network stays as it is: {}\n", role_, refusal.what());
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string NetemSwitch::switch_to(const std::string& profile) {
  const Profile fresh = load_profile(profile);
  if (!emulator_)
    throw environment_error("this process runs without an emulated network; start it with --netem");
  emulator_->set_profile(fresh);
  return trace_note(fresh);
}

}  // namespace telekerf::netem
