// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_flags.h"

#include <ctime>
#include <sstream>

namespace telekerf {

void BusFlags::add_parameters(Settings& settings) {
  settings.add("domain", domain, {.min = 0, .max = 232}, "DDS domain");
  settings.add("cell", cell, kName, "name of the work cell; cells do not see each other");
  settings.add("name", name, kName, "name of this process, unique in the cell");
  settings.add("peers", peers, TextForm{"HOST,HOST..."},
               "hosts to look for beyond the reach of multicast, separated by commas");
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
  return settings;
}

void add_figures(const BusCounters& counters, const ReaderCounters& stream, Metrics& figures) {
  figures["misfits"] = static_cast<double>(counters.incompatible);
  figures["damaged"] = static_cast<double>(stream.damaged);
}

}  // namespace telekerf
