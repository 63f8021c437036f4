// SPDX-License-Identifier: Apache-2.0
#include "common/bus/process.h"

#include <fmt/format.h>

#include "common/runtime/real_time.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

const BusSettings& with_signals_caught(const BusSettings& settings) {
  catch_stop_signals();
  return settings;
}

}  // namespace

Process::Process(const BusSettings& settings, const std::string& who, const char* initial_state)
    : bus_(with_signals_caught(settings)),
      status_(who, initial_state),
      lookout_(bus_, status_),
      clock_(bus_),
      looking_(std::chrono::milliseconds(100), [this] { look(); }) {
  status_.say(bus_.protection());
}

void Process::look() {
  if (turns_.load(std::memory_order_relaxed) && !ready_said_) ready();
  lookout_.look();
  supervision_.tell();
  clock_.tell();
  for (const std::string& sentence : bus_.dates()) status_.say(sentence);
  ended_.store(!bus_.ended().empty(), std::memory_order_relaxed);
}

void Process::refuse_ended() const {
  if (const std::string why = bus_.ended(); !why.empty()) throw environment_error(why);
}

std::string Process::place() const {
  return fmt::format("cell '{}' of domain {}", bus_.settings().cell, bus_.settings().domain);
}

void Process::ready() {
  ready_said_ = true;
  status_.say(fmt::format("ready in {}", bus_.settings().cell));
}

LoopStatistics Process::run(double rate_hz, const std::function<bool(std::int64_t)>& step) {
  for (const std::string& remark : real_time_remarks()) status_.say(remark);
  const LoopStatistics loop = run_loop(rate_hz, [&](std::int64_t now_ns) {
    supervision_.step();
    const bool goes_on = step(now_ns);
    turns_.store(true, std::memory_order_relaxed);
    return goes_on && !stop_requested() && !ended();
  });
  supervision_.over();
  return loop;
}

}  // namespace telekerf
