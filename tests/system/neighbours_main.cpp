// SPDX-License-Identifier: Apache-2.0
// One process of a secured cell, for test_secured: DOMAIN KEYS ROLE OTHERS. Ends with 0 when it has seen that
// many others, and stays for two seconds more, so that they see it; ends with 1 after 20 s, and says whom it
// saw.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "common/bus/bus.h"

int main(int, char** arguments) {
  using namespace telekerf;
  using Clock = std::chrono::steady_clock;
  BusSettings settings;
  settings.domain = std::atoi(arguments[1]);
  settings.cell = "cell-1";
  settings.security = arguments[2];
  settings.role = arguments[3];
  settings.discovery_wait = std::chrono::milliseconds(0);
  const auto wanted = static_cast<std::size_t>(std::atoi(arguments[4]));
  const Bus bus(settings);
  const auto end = Clock::now() + std::chrono::seconds(20);
  while (bus.others().size() < wanted) {
    if (Clock::now() > end) {
      for (const PresenceMessage& other : bus.others()) fmt::print("{} sees {}\n", settings.role, other.role);
      return 1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  return 0;
}
