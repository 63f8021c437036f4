// SPDX-License-Identifier: Apache-2.0
// telekerf-netem list: the shipped profiles at a glance.
#include <fmt/format.h>

#include <string>

#include "common/runtime/resources.h"
#include "netem/commands/commands.h"
#include "netem/core/delay_distribution.h"
#include "netem/core/loss_chain.h"
#include "netem/core/profile.h"

namespace telekerf::netem {
namespace {

int print_list() {
  fmt::print("{:<16} {:>15} {:>15} {:>13} {:<8} {}\n", "profile", "forward ms", "backward ms", "loss",
             "order", "");
  for (const auto& name : shipped_names("profiles", ".toml")) {
    const Profile profile = load_profile(name);
    const auto delay = [](const DirectionProfile& direction) {
      const Moments moments = delay_moments(direction.stages.front().conditions.delay);
      if (moments.sd_s == 0) return fmt::format("{:.4g}", moments.mean_s * 1e3);
      return fmt::format("{:.4g} ± {:.3g}", moments.mean_s * 1e3, moments.sd_s * 1e3);
    };
    const Conditions& forward = profile.forward.stages.front().conditions;
    const LossChain chain = loss_chain(forward.loss, 0.0);
    std::string loss = fmt::format("{:g}", mean_loss(chain));
    if (forward.loss.burst_s > 0) {
      loss += fmt::format(" by {:.3g} ms", forward.loss.burst_s * 1e3);
    } else if (chain.states > 1) {
      loss += fmt::format(" by {:.2g}", mean_burst(chain));
    }
    // fmt counts "±" as one column.
    fmt::print("{:<16} {:>15} {:>15} {:>13} {:<8} {}{}\n", name, delay(profile.forward),
               delay(profile.backward), loss, forward.tcp_like ? "tcp" : kOrders.word(forward.order),
               profile.description, profile.forward.events.empty() ? "" : "; with events");
  }
  fmt::print(
      "\nmean ± standard deviation of the delay that is drawn, one way; loss as a fraction, mean burst "
      "length in packets or ms, forward\n");
  return 0;
}

}  // namespace

void add_list_command(Program& program) {
  struct ListOptions {};
  program.add(
      "list", "Shows the shipped profiles", ListOptions{}, [](ListOptions&, Settings&) {},
      [](const ListOptions&) { return print_list(); });
}

}  // namespace telekerf::netem
