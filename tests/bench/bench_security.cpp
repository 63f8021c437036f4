// SPDX-License-Identifier: Apache-2.0
// What DDS Security costs: round trips of blocks with and without it, in turns within one run, and the
// processor's share at the blocks' rate. Both ends in one process, over loopback; whoever hears a block
// answers from the middleware's thread; on idle processors and again with a busy thread on each.
// Usage: bench_security [STORE]   a folder made by telekerf-keys; without: one is made for the run
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "common/bus/endpoints.h"
#include "common/bus/security/keystore.h"
#include "common/runtime/clock.h"
#include "tests/bench/measures.h"

namespace telekerf {
namespace {

using namespace std::chrono_literals;

using bench::processor_s;
using bench::quantile;

constexpr int kRounds = 8, kTrips = 500;
constexpr double kRate_s = 5.0;

BusSettings settings(const std::string& role, Site site, int domain, const std::string& store) {
  BusSettings made;
  made.domain = domain;
  made.cell = store.empty() ? "plain" : "cell-1";
  made.site = site;
  made.role = role;
  made.epoch = 1;
  made.outside = false;
  made.discovery_wait = 50ms;
  made.security = store;
  return made;
}

/// Master and slave; the slave answers each command.
class Pair {
 public:
  Pair(int domain, const std::string& store)
      : master_(settings("master", Site::kOperator, domain, store)),
        slave_(settings("slave", Site::kSlave, domain, store)),
        states_(slave_),
        heard_(slave_, [this](const CommandBlock& command) { answer(command); }),
        commands_(master_),
        seen_(master_, [this](const StateBlock& state) {
          trip_ns_ = monotonic_ns() - state.echo_sent_ns;
          answered_.store(state.echo_sequence, std::memory_order_release);
        }) {
    while (commands_.readers() == 0 || states_.readers() == 0) std::this_thread::sleep_for(5ms);
    for (int i = 0; i < 200; ++i) (void)trip_us();
  }

  void command() {
    CommandBlock command;
    command.sequence = ++sequence_;
    command.epoch = 1;
    command.payload.size = 60;
    command.sent_ns = monotonic_ns();
    (void)commands_.write(command);
  }
  /// Negative: lost. `write_us`: what the caller of write() waits.
  double trip_us(double* write_us = nullptr) {
    CommandBlock command;
    command.sequence = ++sequence_;
    command.epoch = 1;
    command.payload.size = 60;
    command.sent_ns = monotonic_ns();
    (void)commands_.write(command);
    if (write_us != nullptr) *write_us = static_cast<double>(monotonic_ns() - command.sent_ns) * 1e-3;
    const std::int64_t end_ns = command.sent_ns + 100'000'000;
    while (answered_.load(std::memory_order_acquire) != sequence_) {
      if (monotonic_ns() > end_ns) return -1.0;
      std::this_thread::sleep_for(1us);
    }
    return static_cast<double>(trip_ns_) * 1e-3;
  }

 private:
  void answer(const CommandBlock& command) {
    StateBlock state;
    state.sequence = command.sequence;
    state.epoch = 1;
    state.payload.size = 60;
    state.echo_sequence = command.sequence;
    state.echo_sent_ns = command.sent_ns;
    (void)states_.write(state);
  }

  Bus master_, slave_;
  Writer<StateBlock> states_;
  Reader<CommandBlock> heard_;
  Writer<CommandBlock> commands_;
  std::int64_t trip_ns_ = 0;
  std::atomic<std::uint32_t> answered_{0};
  Reader<StateBlock> seen_;
  std::uint32_t sequence_ = 0;
};

/// Share of one processor that both ends take together at 62.5 blocks a second each way.
double share(Pair* pair) {
  const double before_s = processor_s();
  const auto begin = std::chrono::steady_clock::now();
  auto next = begin;
  while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(kRate_s)) {
    if (pair != nullptr) pair->command();  // nobody waits for the answer
    std::this_thread::sleep_until(next += 16ms);
  }
  return (processor_s() - before_s) / kRate_s;
}

/// A thread on each processor that never sleeps, while it lives.
class Load {
 public:
  Load() {
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
      threads_.emplace_back([](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
        }
      });
    }
  }

 private:
  std::vector<std::jthread> threads_;
};

struct Way {
  const char* name;
  std::unique_ptr<Pair> pair;
  std::vector<double> trips, writes;
  int lost = 0;
  std::vector<double> shares;
};

void make_trips(std::vector<Way>& ways) {
  for (int round = 0; round < kRounds; ++round) {
    for (Way& way : ways) {
      for (int i = 0; i < kTrips; ++i) {
        double write_us = 0.0;
        const double trip = way.pair->trip_us(&write_us);
        way.writes.push_back(write_us);
        if (trip < 0.0)
          ++way.lost;
        else
          way.trips.push_back(trip);
      }
    }
  }
}

int run(std::string store) {
  std::filesystem::path made;
  if (store.empty()) {
    made = std::filesystem::temp_directory_path() / fmt::format("telekerf-bench-keys-{}", ::getpid());
    security::make_keystore(made, {"cell-1"}, 24h);
    store = made.string();
  }
  const int domain = 100 + ::getpid() % 100;
  std::vector<Way> ways;
  ways.push_back({"none", std::make_unique<Pair>(domain, ""), {}, {}, 0, {}});
  ways.push_back({"signed", std::make_unique<Pair>(domain, store), {}, {}, 0, {}});
  make_trips(ways);
  for (int round = 0; round < 2; ++round) {
    for (Way& way : ways) way.shares.push_back(share(way.pair.get()));
  }
  const double idle = share(nullptr);
  fmt::print("{:<8} {:>9} {:>9} {:>11} {:>6} {:>22}\n", "", "p50 us", "p99 us", "write p50", "lost",
             "core %, both ends");
  for (const Way& way : ways)
    fmt::print("{:<8} {:>9.1f} {:>9.1f} {:>11.1f} {:>6} {:>22.2f}\n", way.name, quantile(way.trips, 0.5),
               quantile(way.trips, 0.99), quantile(way.writes, 0.5), way.lost,
               100 * (quantile(way.shares, 0.0) - idle));
  const auto ratio = [&] { return quantile(ways[1].trips, 0.5) / quantile(ways[0].trips, 0.5); };
  fmt::print("p50 with it / without, idle: {:.2f}\n", ratio());
  for (Way& way : ways) way.trips.clear();
  {
    const Load load;
    make_trips(ways);
  }
  fmt::print("... with a busy thread on each processor: {:.1f} / {:.1f} us = {:.2f}\n",
             quantile(ways[1].trips, 0.5), quantile(ways[0].trips, 0.5), ratio());
  ways.clear();
  if (!made.empty()) std::filesystem::remove_all(made);
  return 0;
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) { return telekerf::run(argc > 1 ? argv[1] : ""); }
