// SPDX-License-Identifier: Apache-2.0
#include "common/bus/send_event.h"

#include <fmt/format.h>

#include <chrono>

#include "common/bus/endpoints.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

StartupError nobody_listens(const Bus& bus) {
  return environment_error(
      fmt::format("nobody listens in cell '{}' of domain {}: start its processes first, or give "
                  "their --cell and --domain",
                  bus.settings().cell, bus.settings().domain));
}

std::size_t tell(Bus& bus, const EventMessage& event) {
  Writer<EventMessage> writer(bus);
  constexpr std::chrono::seconds kPatience{5};
  const std::size_t others = bus.others().size();
  if (others == 0 || !writer.wait_for_reader(kPatience)) {
    throw nobody_listens(bus);
  }
  // Who is there hears it at once, the rest as soon as they are found.
  const int first = writer.readers();
  bool sent = writer.write(event);
  (void)writer.wait_for_reader(kPatience, static_cast<int>(others));
  if (writer.readers() > first) sent = writer.write(event) && sent;
  if (!sent) throw environment_error("the event could not be sent");
  if (!writer.wait_until_received(kPatience))
    throw environment_error(
        fmt::format("not everyone in cell '{}' has confirmed it within {} s: see to it at the machine",
                    bus.settings().cell, kPatience.count()));
  return others;
}

}  // namespace telekerf
