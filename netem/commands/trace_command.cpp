// SPDX-License-Identifier: Apache-2.0
// telekerf-netem trace and replay: the outcome of every packet as CSV, written and played back.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "common/runtime/startup_error.h"
#include "netem/commands/commands.h"
#include "netem/commands/link_command.h"
#include "netem/core/emulator.h"
#include "netem/core/random.h"
#include "netem/core/trace.h"
#include "netem/drivers/tun_link.h"

namespace telekerf::netem {
namespace {

struct TraceOptions {
  std::string profile;
  double rate_hz = 1000.0;
  std::uint64_t packets = 1000;
  std::uint64_t seed = 1;
  std::uint32_t bytes = 200;
  Direction direction = Direction::kForward;
};

/// Sends one packet and takes everything that is due, so that the emulator never fills up.
RecordedOutcome send(Emulator& emulator, std::int64_t now_ns, std::uint32_t bytes, std::uint64_t index) {
  while (emulator.pop(now_ns)) {
  }
  const PacketOutcome outcome = emulator.push(now_ns, bytes, index);
  if (outcome.overflowed)
    throw usage_error("more packets under way than this program holds; lower --rate-hz");
  return {now_ns, outcome.lost() ? 0 : outcome.due_ns - now_ns, outcome.lost(), outcome.duplicated,
          outcome.corrupted};
}

Capacity roomy() {
  Capacity capacity;
  capacity.packets = 1U << 20;
  capacity.bytes = 0;  // sizes only
  return capacity;
}

int print_trace(const TraceOptions& options) {
  const Profile profile = load_profile(options.profile);
  constexpr double kLongest_s = 1e9;
  if (static_cast<double>(options.packets) > kLongest_s * options.rate_hz)
    throw usage_error(fmt::format("{} packets at --rate-hz {:g} take more than {:g} s", options.packets,
                                  options.rate_hz, kLongest_s));
  const bool forward = options.direction == Direction::kForward;
  Emulator emulator(forward ? profile.forward : profile.backward, {options.seed, 0, options.direction},
                    roomy());
  fmt::print("{}\n", kTraceHeader);
  if (const std::string note = trace_note(profile); !note.empty())
    fmt::print(stderr, "telekerf-netem: {}\n", note);
  for (std::uint64_t i = 0; i < options.packets; ++i) {
    const auto now_ns =
        static_cast<std::int64_t>(std::llround(static_cast<double>(i) * 1e9 / options.rate_hz));
    fmt::print("{}\n", trace_row(i, send(emulator, now_ns, options.bytes, i)));
  }
  if (const auto after = emulator.counters().after_trace; after > 0) {
    fmt::print(stderr, "telekerf-netem: {} packets were sent after the recording's end and count as lost\n",
               after);
  }
  return 0;
}

/// Plays a recording in virtual time; what comes out must be the recording again.
int print_replay(const std::string& file) {
  const Recording recording = load_recording(file);
  DirectionProfile profile;
  profile.recording = std::make_shared<Recording>(recording);
  Emulator emulator(profile, {}, roomy());
  fmt::print("{}\n", kTraceHeader);
  std::uint64_t differing = 0;
  for (std::uint64_t i = 0; i < recording.size(); ++i) {
    const std::string row = trace_row(i, send(emulator, recording[i].in_ns, 0, i));
    differing += row != trace_row(i, recording[i]);
    fmt::print("{}\n", row);
  }
  if (differing > 0)
    fmt::print(stderr, "telekerf-netem: {} packets came out otherwise than recorded\n", differing);
  return differing == 0 ? 0 : 1;
}

}  // namespace

void add_trace_command(Program& program) {
  program.add(
      "trace", "Prints the fate of every packet as CSV, without sending any", TraceOptions{},
      [](TraceOptions& o, Settings& s) {
        s.add("profile", o.profile, kProfile, "a shipped name, a TOML file or a trace").as_argument();
        s.add("rate_hz", o.rate_hz, {.min = 0.001, .max = 1e9, .unit = "Hz"}, "packets a second");
        s.add("packets", o.packets, kSeeds, "how many");
        s.add("seed", o.seed, kSeeds, "of the random numbers");
        s.add("bytes", o.bytes, {.min = 1, .max = 65535, .unit = "bytes"},
              "size of a packet, for rates and slots");
        s.add("direction", o.direction, kDirections, "which way");
      },
      print_trace);
}

void add_replay_command(Program& program) {
  struct TraceOptions {
    LinkOptions link;
    bool linked = false;
  };
  program.add(
      "replay", "Plays a recorded trace: in virtual time as CSV, or with --link between two networks",
      TraceOptions{},
      [](TraceOptions& o, Settings& s) {
        s.add("trace", o.link.profile, kFile, "CSV as printed by `telekerf-netem trace`").as_argument();
        s.add("link", o.linked, "drive the TUN link with it, both directions");
        add_link_parameters(o.link, s);
        s.only_with({"seed", "operator_dev", "slave_dev", "operator_netns", "slave_netns", "operator_address",
                     "slave_address", "operator_default_route", "slave_default_route", "record", "seconds"},
                    "link", {"true"});
      },
      [](const TraceOptions& o) { return o.linked ? run_link(o.link) : print_replay(o.link.profile); });
}

}  // namespace telekerf::netem
