// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_flags.h"

#include <random>
#include <sstream>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

std::vector<std::string> hosts_of(const std::string& peers) {
  std::vector<std::string> hosts;
  std::istringstream words(peers);
  for (std::string host; std::getline(words, host, ',');) {
    if (!host.empty()) hosts.push_back(host);
  }
  return hosts;
}

std::string complaint_about_peers(const std::string& peers) {
  const std::vector<std::string> hosts = hosts_of(peers);
  if (hosts.empty()) return "names no host";
  for (const std::string& host : hosts) {
    if (const std::string wrong = complaint_about_peer(host); !wrong.empty()) return wrong;
  }
  return "";
}

}  // namespace

void BusFlags::add_parameters(Settings& settings) {
  settings.add("domain", domain, {.min = 0, .max = 232}, "DDS domain");
  settings.add("cell", cell, TextForm{.form = "NAME", .complaint = complaint_about_cell},
               "name of the work cell; cells do not see each other");
  settings.add("name", name, kName, "name of this process, unique in the cell");
  settings.add("peers", peers, TextForm{.form = "HOST,HOST...", .complaint = complaint_about_peers},
               "hosts to look for beyond the reach of multicast, separated by commas");
  settings.add(
      "security", security, kFolder,
      "keys of the cell (./telekerf keys): only who has some is heard; without: within this computer alone");
  settings.add("wan", wan,
               "with security: messages are encrypted and not only signed; everywhere or nowhere");
  settings.add("insecure", insecure,
               "without security: heard beyond this computer all the same, by whoever is there");
}

BusSettings BusFlags::bus_settings(Site site, const std::string& role) const {
  if (wan && security.empty())
    throw usage_error("--wan needs --security DIR: there is nothing to encrypt with");
  if (insecure && !security.empty())
    throw usage_error("--insecure and --security do not go together: leave one out");
  BusSettings settings;
  settings.domain = domain;
  settings.cell = cell;
  settings.site = site;
  settings.role = role;
  settings.name = name;
  // Two starts within a second, or without a clock that knows the date, are two.
  std::random_device random;
  while (settings.epoch == 0) settings.epoch = random();
  settings.peers = hosts_of(peers);
  settings.security = security;
  settings.wan = wan;
  settings.outside = insecure;
  return settings;
}

RunIdentity run_identity(const BusSettings& settings, const std::string& program, const std::string& config) {
  return {.role = settings.role,
          .program = program,
          .cell = settings.cell,
          .epoch = settings.epoch,
          .settings = config};
}

void add_figures(const BusCounters& counters, const ReaderCounters& stream, Metrics& figures) {
  figures["misfits"] = static_cast<double>(counters.incompatible);
  figures["strangers"] = static_cast<double>(stream.strangers);
  figures["unauthenticated"] = static_cast<double>(counters.refused);
  figures["damaged"] = static_cast<double>(stream.damaged);
}

}  // namespace telekerf
