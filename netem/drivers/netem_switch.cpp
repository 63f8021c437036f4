// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/netem_switch.h"

#include <fmt/format.h>

#include <cstdio>

#include "netem/core/profile.h"

namespace telekerf {

void NetemSwitch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    while (const auto event = events_.take()) {
      if (event->value.kind != EventMessage::Kind::kSetNetem) continue;
      try {
        bus_.set_profile(netem::load_profile(event->value.text));
        fmt::print("{}: the network is now '{}'\n", bus_.settings().role, event->value.text);
        std::fflush(stdout);
      } catch (const StartupError& refusal) {
        fmt::print(stderr, "{}: the network stays as it is: {}\n", bus_.settings().role, refusal.what());
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace telekerf
