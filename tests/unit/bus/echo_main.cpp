// SPDX-License-Identifier: Apache-2.0
// A slave for test_processes: answers every command block with a state block until it is killed.
#include <cstdlib>

#include "common/bus/endpoints.h"
#include "common/runtime/clock.h"

int main(int, char** arguments) {
  using namespace telekerf;
  BusSettings settings;
  settings.domain = std::atoi(arguments[1]);
  settings.cell = arguments[2];
  settings.site = Site::kSlave;
  settings.role = "slave";
  settings.discovery_wait = std::chrono::milliseconds(20);
  Bus bus(settings);
  Reader<CommandBlock> commands(bus);
  Writer<StateBlock> states(bus);
  const std::int64_t end_ns = monotonic_ns() + 120 * kNanosecondsPerSecond;  // never a leftover
  while (monotonic_ns() < end_ns) {
    while (const auto command = commands.take()) {
      StateBlock state;
      state.echo_sequence = command->value.sequence;
      state.echo_sent_ns = command->value.sent_ns;
      state.payload = command->value.payload;
      states.write(state);
    }
    sleep_until_ns(monotonic_ns() + 100'000);
  }
}
