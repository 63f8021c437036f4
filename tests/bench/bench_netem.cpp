// SPDX-License-Identifier: Apache-2.0
// Throughput and memory of the emulation core beside a plain std::priority_queue of the same events, in the
// same run.
//
// Method: the emulator and the queue hold the same packets under way, with the same due times (the queue gets
// the ones that the emulator drew, worked out beforehand: it has no law to draw from). Both push at 1 kHz of
// virtual time and pop whatever is due. The two are measured in alternating rounds with another seed each;
// the first rounds warm up. Packets are pushed as sizes: the queue holds no payload either. Ratio = queue
// time / emulator time, of the medians; 1x means as fast although every law is drawn as well.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <queue>
#include <vector>

#include "netem/core/emulator.h"

namespace telekerf::netem {
namespace {

constexpr int kPackets = 100'000;
constexpr int kRounds = 41;
constexpr int kWarmUp = 3;
constexpr std::int64_t kStep_ns = 1'000'000;

struct Event {
  std::int64_t due_ns;
  std::uint64_t sequence;
  std::int64_t in_ns;
  std::uint64_t tag;
  std::uint32_t size;
  bool corrupted;
  bool duplicate;
  bool operator<(const Event& other) const {
    return due_ns != other.due_ns ? due_ns > other.due_ns : sequence > other.sequence;
  }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  std::vector<double> s;
  double at(double share) {
    std::sort(s.begin(), s.end());
    return s[static_cast<std::size_t>(share * static_cast<double>(s.size() - 1))];
  }
};

std::uint64_t checksum = 0;  // keeps the compiler from dropping the work

double time_emulator(const DirectionProfile& profile, std::uint64_t seed, std::uint32_t capacity) {
  Emulator emulator(profile, {seed}, {capacity, 0, 0});
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kPackets; ++i) {
    const std::int64_t now_ns = i * kStep_ns;
    while (const auto delivery = emulator.pop(now_ns)) checksum += delivery->tag;
    emulator.push(now_ns, 200U, static_cast<std::uint64_t>(i));
  }
  return seconds_since(start);
}

/// The events that the emulator makes of the same packets, and the most that are ever under way at once.
std::vector<std::vector<Event>> events_of(const DirectionProfile& profile, std::uint64_t seed,
                                          std::uint32_t* most) {
  Emulator emulator(profile, {seed}, {1U << 20, 0, 0});
  std::vector<std::vector<Event>> events(kPackets);
  std::uint64_t sequence = 0;
  std::uint64_t under_way = 0;
  for (int i = 0; i < kPackets; ++i) {
    const std::int64_t now_ns = i * kStep_ns;
    while (emulator.pop(now_ns)) --under_way;
    const PacketOutcome outcome = emulator.push(now_ns, 200U, static_cast<std::uint64_t>(i));
    if (outcome.lost()) continue;
    for (int copy = 0; copy < 1 + outcome.duplicated; ++copy) {
      events[i].push_back(
          {outcome.due_ns, sequence++, now_ns, static_cast<std::uint64_t>(i), 200, outcome.corrupted, copy > 0});
      ++under_way;
    }
    *most = std::max(*most, static_cast<std::uint32_t>(under_way));
  }
  return events;
}

double time_queue(const std::vector<std::vector<Event>>& events, std::uint32_t capacity) {
  std::vector<Event> storage;
  storage.reserve(capacity);
  std::priority_queue<Event> queue(std::less<Event>(), std::move(storage));
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kPackets; ++i) {
    const std::int64_t now_ns = i * kStep_ns;
    while (!queue.empty() && queue.top().due_ns <= now_ns) {
      checksum += queue.top().tag;
      queue.pop();
    }
    for (const Event& event : events[i]) queue.push(event);
  }
  return seconds_since(start);
}

bool compare(const char* name, const std::string& text, double needed) {
  const DirectionProfile profile = parse_profile(text, name).forward;
  std::uint32_t most = 0;
  events_of(profile, 1, &most);
  const std::uint32_t capacity = most + most / 4;  // the fullest moment differs a little from seed to seed
  Times emulator;
  Times queue;
  Times ratios;
  for (int round = 0; round < kRounds + kWarmUp; ++round) {
    std::uint32_t ignored = 0;
    const auto events = events_of(profile, round, &ignored);
    const double queue_s = time_queue(events, capacity);
    const double emulator_s = time_emulator(profile, round, capacity);
    if (round < kWarmUp) continue;
    queue.s.push_back(queue_s);
    emulator.s.push_back(emulator_s);
    ratios.s.push_back(queue_s / emulator_s);
  }
  const double ratio = ratios.at(0.5);
  const double memory = static_cast<double>(Emulator(profile, {}, {capacity, 0, 0}).memory_bytes()) /
                        (static_cast<double>(capacity) * sizeof(Event));
  const auto ns = [](double s) { return s * 1e9 / kPackets; };
  fmt::print(
      "{:<30} under way {:>6}  core {:>5.0f} / {:>5.0f} / {:>5.0f} ns  queue {:>5.0f} / {:>5.0f} / {:>5.0f} "
      "ns  "
      "{:.2f}x (bar {:.1f}x)  memory {:.2f}x (bar 2.0x)\n",
      name, most, ns(emulator.at(0.5)), ns(emulator.at(0.99)), ns(emulator.at(1.0)), ns(queue.at(0.5)),
      ns(queue.at(0.99)), ns(queue.at(1.0)), ratio, needed, memory);
  return ratio >= needed && memory <= 2.0;
}

int run() {
  const std::string all =
      "jitter_ms = 30\ndistribution = \"gamma\"\nshape = 2\ncorrelation_ms = 0.830584\nloss_model = "
      "\"gilbert-elliott\"\n"
      "loss = 0.02\nloss_burst_packets = 4\nduplicate = 0.02\ncorrupt = 0.01\nrate_kbit_per_s = 10000\n"
      "queue_bytes = 100000\n";
  const std::string event =
      "\n[[event]]\nevery_s = 15\nduration_ms = 140\nadd_delay_ms = [0, 50]\nloss = 0.3\n";
  bool good = true;
  fmt::print("median / p99 / max of {} rounds, per packet\n", kRounds);
  for (const int delay_ms : {50, 150, 1000}) {
    const std::string delay = fmt::format("[both]\ndelay_ms = {}\n", delay_ms);
    const auto name = [&](const char* what) { return fmt::format("{}, {} ms", what, delay_ms); };
    good &= compare(name("fifo, constant").c_str(), delay, 1.0);
    good &= compare(name("fifo, everything on").c_str(), fmt::format("{}{}{}", delay, all, event), 1.0);
    good &= compare(name("free, everything on").c_str(),
                    fmt::format("{}{}order = \"free\"\n{}", delay, all, event), 0.5);
  }
  fmt::print("checksum {}\n", checksum);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace telekerf::netem

int main() { return telekerf::netem::run(); }
