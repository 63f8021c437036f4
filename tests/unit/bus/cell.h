// SPDX-License-Identifier: Apache-2.0
// Participants for tests: a domain and a cell of this process' own keep tests that run side by side apart.
#pragma once

#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/endpoints.h"

namespace telekerf {

using namespace std::chrono_literals;

inline constexpr auto kPatience = 20s;  // sanitizers and a busy machine

inline BusSettings settings(const std::string& role, Site site = Site::kOperator) {
  BusSettings settings;
  // Below 102: the ports of the others are handed out to whoever sends, and nobody is found where one is taken.
  settings.domain = 1 + getpid() % 100;
  settings.cell = "test-" + std::to_string(getpid());
  settings.site = site;
  settings.role = role;
  settings.discovery_wait = 20ms;
  return settings;
}

inline EventMessage event(std::uint32_t epoch) {
  EventMessage message;
  message.epoch = epoch;
  return message;
}

template <class Condition>
bool soon(Condition condition, std::chrono::nanoseconds patience = kPatience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(500us);
  }
  return true;
}

template <class T>
std::optional<Received<T>> take_soon(Reader<T>& reader, std::chrono::nanoseconds patience = kPatience) {
  std::optional<Received<T>> sample;
  (void)soon([&] { return (sample = reader.take()).has_value(); }, patience);
  return sample;
}

}  // namespace telekerf
