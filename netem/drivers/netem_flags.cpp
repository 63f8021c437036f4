// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/netem_flags.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/runtime/resources.h"

namespace telekerf::netem {

void NetemFlags::add_parameters(Settings& settings) {
  TextForm profile_or_none = kProfile;
  profile_or_none.complaint = [](const std::string& name) {
    return name == "none" ? std::string()
                          : complaint_about_resource(kProfile.shipped, name, kProfile.extension);
  };
  settings.add("netem", profile, profile_or_none,
               "emulated network between the sites: a profile's name or file, none: the real one");
  settings.add("netem_seed", seed, kSeeds, "of the emulated network");
}

std::shared_ptr<ReceivePathEmulator> NetemFlags::emulator(Site own_site) const {
  if (profile == "none") return nullptr;
  const Profile loaded = load_profile(profile);
  if (const std::string note = trace_note(loaded); !note.empty())
    fmt::print("network '{}': {}\n", name(), note);
  return std::make_shared<ReceivePathEmulator>(loaded, seed, own_site);
}

std::string NetemFlags::name() const { return std::filesystem::path(profile).stem().string(); }

RunIdentity NetemFlags::with_network(RunIdentity identity) const {
  identity.words["netem"] = name();
  if (profile == "none") return identity;
  std::ifstream in(find_resource(kProfile.shipped, profile, kProfile.extension));
  identity.network.assign(std::istreambuf_iterator<char>(in), {});
  return identity;
}

void add_figures(const ReceivePathEmulator* emulator, Metrics& figures) {
  const TransportCounters counters = emulator ? emulator->counters() : TransportCounters{};
  figures["netem_datagrams"] = static_cast<double>(counters.emulated);
  figures["netem_lost"] = static_cast<double>(counters.lost);
  figures["netem_overflowed"] = static_cast<double>(counters.overflowed);
  figures["netem_corrupted"] = static_cast<double>(counters.corrupted);
  figures["netem_corrupted_to_bus"] = static_cast<double>(counters.delivered_corrupted);
  figures["netem_latest_ms"] = static_cast<double>(counters.latest_ns) * 1e-6;
}

}  // namespace telekerf::netem
