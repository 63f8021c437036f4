// SPDX-License-Identifier: Apache-2.0
// telekerf-netem tc: the profile as a shell script for tc, shortcomings as comments.
#include <fmt/format.h>

#include "common/runtime/startup_error.h"
#include "netem/commands/commands.h"
#include "netem/core/random.h"
#include "netem/drivers/tc.h"

namespace telekerf::netem {
namespace {

struct TcOptions {
  std::string profile;
  std::string device;
  Direction direction = Direction::kForward;
  std::int64_t packet_bytes = kTcPacket_bytes;
};

int run_tc(const TcOptions& options) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-@";
  constexpr std::size_t kLongest = 15;  // the kernel's limit
  if (options.device.empty() || options.device.size() > kLongest ||
      options.device.find_first_not_of(kPlain) != std::string::npos) {
    throw usage_error(
        fmt::format("--dev '{}' is no network device name: 1 to {} letters, digits, '.', '_', '-' or '@'",
                    options.device, kLongest));
  }
  const Profile profile = load_profile(options.profile);
  const bool forward = options.direction == Direction::kForward;
  const TcExport out =
      export_to_tc(forward ? profile.forward : profile.backward, options.device, options.packet_bytes);
  fmt::print(
      "# {}: what leaves {} ({})\n", profile.name, options.device,
      forward ? "forward: run this on the operator's machine" : "backward: run this on the slave's machine");
  for (const auto& shortcoming : out.shortcomings) fmt::print("# tc falls short: {}\n", shortcoming);
  fmt::print("{}\n", out.command);
  return 0;
}

}  // namespace

void add_tc_command(Program& program) {
  program.add(
      "tc", "Prints the profile as tc commands and names what tc cannot express", TcOptions{},
      [](TcOptions& o, Settings& s) {
        s.add("profile", o.profile, kProfile, "a shipped name, a TOML file or a trace").as_argument();
        s.add("dev", o.device, TextForm{"DEVICE"}, "network device").must_be_given();
        s.add("direction", o.direction, kDirections, "which way");
        s.add("packet_bytes", o.packet_bytes, {.min = 1, .max = 65535, .unit = "bytes"},
              "size of a packet, for the limit beside a rate: tc counts packets");
      },
      run_tc);
}

}  // namespace telekerf::netem
