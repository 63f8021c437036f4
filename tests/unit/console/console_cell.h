// SPDX-License-Identifier: Apache-2.0
// A console with two pages in virtual time, without a socket: what they say and what they get.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "master/console/console.h"
#include "master/console/driver_seat.h"
#include "tests/unit/console/frames.h"

namespace telekerf::master {

inline constexpr std::int64_t kMs = 1'000'000;

inline ContourMessage contour(std::uint32_t id, const std::string& source) {
  ContourMessage message;
  message.id = id;
  message.source = source;
  return message;
}

class ConsoleTest : public ::testing::Test {
 protected:
  void say(std::uint32_t page, const std::string& json) { console.hear_command(page, json, now_ns); }
  void take(std::uint32_t page) { say(page, R"({"do":"take","text":"secret-token"})"); }
  /// The frame's page clock is the test's.
  void move(std::uint32_t page, std::uint16_t flags, std::int64_t age_ms = 0) {
    PageFrame frame;
    frame.flags = flags;
    frame.sequence = ++sequence;
    frame.page_ms = static_cast<double>(now_ns / kMs - age_ms);
    frame.x_m = 0.001F;
    frame.lease = lease;
    console.hear_frame(page, testing::bytes_of(frame), now_ns);
  }
  void pass(std::int64_t ms) {
    now_ns += ms * kMs;
    console.step(now_ns);
  }
  /// Everything that a page gets, the states but the last left out; learns the lease.
  std::vector<nlohmann::json> read(std::uint32_t page) {
    std::vector<nlohmann::json> texts;
    for (int n = 0; n < 20; ++n) {
      const auto message = console.next(page, now_ns);
      if (!message) break;
      if (message->binary) {
        if (message->bytes[0] == 1) state = message->bytes;
        continue;
      }
      texts.push_back(nlohmann::json::parse(message->bytes));
      if (texts.back()["type"] == "lease") lease = texts.back()["lease"];
    }
    return texts;
  }
  /// The newest words that it gets; null: none.
  nlohmann::json words(std::uint32_t page) {
    nlohmann::json words;
    for (const auto& text : read(page))
      if (text["type"] == "words") words = text;
    return words;
  }
  std::string refusal(std::uint32_t page) {
    for (const auto& text : read(page))
      if (text["type"] == "refused") return text["why"];
    return "";
  }
  std::vector<UdpHandFrame> hand() { return console.take_outbox().hand; }
  std::vector<EventMessage> events() { return console.take_outbox().events; }

  Console console{
      {.cell = "c", .source = "operator", .token = "secret-token", .profiles = {"lan"}, .epoch = 5}};
  std::int64_t now_ns = 1'000'000 * kMs;
  std::uint32_t lease = 0;
  std::uint32_t sequence = 0;
  std::string state;
  std::uint32_t first = console.join(now_ns);
  std::uint32_t second = console.join(now_ns);
};

}  // namespace telekerf::master
