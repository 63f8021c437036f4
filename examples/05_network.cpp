// SPDX-License-Identifier: Apache-2.0
// What does a satellite link do to packets?
//
// Ten seconds of packets, one every 16 ms, go through the profile `leo` in both directions, in no time: the
// emulator has no clock, the caller hands it the time. You see delays and losses of either direction. The
// same seed gives every packet the same fate on every machine, and so the second run below repeats the first
// to the nanosecond.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "netem/core/emulator.h"

namespace {

using namespace telekerf::netem;

/// One-way delays of what arrives, ns.
std::vector<std::int64_t> delays_ns(const DirectionProfile& profile, Direction direction,
                                    std::uint64_t seed) {
  Emulator emulator(profile, {.seed = seed, .flow = 0, .direction = direction});
  std::vector<std::int64_t> delays;
  const auto collect = [&](std::int64_t now_ns) {
    while (const auto packet = emulator.pop(now_ns)) delays.push_back(packet->due_ns - packet->in_ns);
  };
  for (std::int64_t n = 0; n < 625; ++n) {
    const std::int64_t now_ns = n * 16'000'000;
    collect(now_ns);
    emulator.push(now_ns, /*size_bytes=*/186, /*tag=*/static_cast<std::uint64_t>(n));
  }
  collect(60'000'000'000);
  return delays;
}

}  // namespace

int main() {
  const Profile profile = load_profile("leo");
  fmt::print("{}: {}\n", profile.name, profile.description);
  bool same = true;
  for (const auto& [name, direction, law] :
       {std::tuple("forward ", Direction::kForward, &profile.forward),
        std::tuple("backward", Direction::kBackward, &profile.backward)}) {
    std::vector<std::int64_t> delays = delays_ns(*law, direction, 1);
    same = same && delays == delays_ns(*law, direction, 1) && delays != delays_ns(*law, direction, 2);
    std::sort(delays.begin(), delays.end());
    const auto at = [&](double part) {
      return 1e-6 * static_cast<double>(
                        delays[static_cast<std::size_t>(part * static_cast<double>(delays.size() - 1))]);
    };
    fmt::print("{}  {} of 625 arrived; delay p50 {:.1f} ms, p99 {:.1f} ms, longest {:.1f} ms\n", name,
               delays.size(), at(0.5), at(0.99), at(1.0));
  }
  fmt::print("same seed, same fates: {}\n", same ? "yes" : "no");
  return same ? 0 : 1;
}
