// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_flags.h"

#include <ctime>
#include <sstream>

namespace telekerf {

void BusFlags::declare(Settings& settings) {
  settings.add("domain", domain, {.min = 0, .max = 232}, "DDS domain");
  settings.add("cell", cell, "name of the work cell; cells do not see each other");
  settings.add("name", name, "name of this process, unique in the cell");
  settings.add("peers", peers, "hosts to look for beyond the reach of multicast, separated by commas");
  settings.add("netem", netem,
               "emulated network between the sites: a profile's name or file, none: the real one");
  settings.add("netem_seed", netem_seed, {.min = 0, .max = 1e15}, "of the emulated network");
}

BusSettings BusFlags::bus_settings(Site site, const std::string& role) const {
  BusSettings settings;
  settings.domain = domain;
  settings.cell = cell;
  settings.site = site;
  settings.role = role;
  settings.name = name;
  settings.epoch = static_cast<std::uint32_t>(std::time(nullptr));
  std::istringstream hosts(peers);
  for (std::string host; std::getline(hosts, host, ',');) {
    if (!host.empty()) settings.peers.push_back(host);
  }
  if (netem != "none") settings.emulation = Emulation{netem::load_profile(netem), netem_seed};
  return settings;
}

void add_figures(const BusCounters& counters, const ReaderCounters& stream, Metrics& figures) {
  figures["misfits"] = static_cast<double>(counters.misfits);
  figures["damaged"] = static_cast<double>(stream.damaged);
  figures["netem_datagrams"] = static_cast<double>(counters.link.emulated);
  figures["netem_lost"] = static_cast<double>(counters.link.lost);
  figures["netem_overflowed"] = static_cast<double>(counters.link.overflowed);
  figures["netem_corrupted"] = static_cast<double>(counters.link.corrupted);
  figures["netem_corrupted_to_bus"] = static_cast<double>(counters.link.delivered_corrupted);
  figures["netem_latest_ms"] = static_cast<double>(counters.link.latest_ns) * 1e-6;
}

}  // namespace telekerf
