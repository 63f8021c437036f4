// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect inputs: which gamepads, pens, SpaceMice and pedals are there, and what they say.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/reporting/tables.h"
#include "common/runtime/clock.h"
#include "common/runtime/loop.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "master/operator/evdev_device.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

using master::EvdevDevice;
using master::EvdevState;
using master::EvdevTraits;
using Json = nlohmann::ordered_json;

struct InputsOptions {
  double seconds = 3.0;
  bool json = false;
};

/// A device, and what it has said while it was watched.
struct Watched {
  explicit Watched(const std::string& where) : path(where), device(where), state(device.traits()) {
    for (const EvdevDevice::Event& event : device.beginning())
      state.hear(event.type, event.code, event.value);
  }
  void read() {
    EvdevDevice::Event event;
    for (;;) {
      switch (device.next(event)) {
        case EvdevDevice::Read::kEvent:
          state.hear(event.type, event.code, event.value);
          // EV_SYN, SYN_REPORT: one report of the device, of however many values.
          if (event.type == 0 && event.code == 0) ++reports;
          continue;
        case EvdevDevice::Read::kLost:
          state.lose();
          continue;
        case EvdevDevice::Read::kGone:
          gone = true;
          return;
        case EvdevDevice::Read::kNothing:
          return;
      }
    }
  }
  /// As master would be told of it.
  std::string serves_as() const {
    const EvdevTraits::Kind kind = device.traits().kind;
    if (kind == EvdevTraits::Kind::kSpaceMouse) return fmt::format("--hand spacemouse:{}", path);
    return fmt::format("--{} evdev:{}", kind == EvdevTraits::Kind::kPedal ? "button" : "hand", path);
  }

  std::string path;
  EvdevDevice device;
  EvdevState state;
  int reports = 0;
  bool gone = false;
};

/// What it says at this moment.
std::string now(Watched& watched) {
  if (watched.gone) return "gone: nothing is held";
  const master::OperatorSample sample = watched.state.sample(monotonic_ns());
  std::string text = sample.held ? "holds" : "lets go";
  if (sample.pointer_m)
    text +=
        fmt::format(", pulls {:.1f}, {:.1f} mm", 1e3 * sample.pointer_m->x(), 1e3 * sample.pointer_m->y());
  return text + (sample.trigger ? ", fires" : "");
}

/// Those that can be opened and are of use; of the others why not.
std::vector<std::unique_ptr<Watched>> open_all(std::vector<std::string>& left_out) {
  std::vector<std::unique_ptr<Watched>> all;
  for (const std::string& path : master::event_devices()) {
    try {
      all.push_back(std::make_unique<Watched>(path));
    } catch (const StartupError& refusal) {
      left_out.emplace_back(refusal.what());
    }
  }
  return all;
}

void print_inputs(const InputsOptions& options, const std::vector<std::unique_ptr<Watched>>& all,
                  const std::vector<std::string>& left_out, double watched_s) {
  Json rows = Json::array();
  for (const auto& watched : all) {
    rows.push_back({{"path", watched->path},
                    {"name", watched->device.name()},
                    {"kind", name_of(watched->device.traits().kind)},
                    {"setting", watched->serves_as()},
                    {"reports_per_s", watched->reports / watched_s},
                    {"now", now(*watched)}});
  }
  if (options.json) {
    fmt::print("{}\n", Json{{"devices", rows}, {"left_out", left_out}, {"watched_s", watched_s}}.dump(2));
    return;
  }
  if (all.empty())
    fmt::print("no gamepad, no pen, no SpaceMouse and no pedal is at this computer (/dev/input)\n");
  for (const Json& row : rows)
    fmt::print("{}: {} ({})\n    {}\n    {:.0f} reports a second while watched; now: {}\n",
               row["path"].get<std::string>(), row["name"].get<std::string>(), row["kind"].get<std::string>(),
               row["setting"].get<std::string>(), row["reports_per_s"].get<double>(),
               row["now"].get<std::string>());
  for (const std::string& refusal : left_out) fmt::print("left out: {}\n", refusal);
}

int watch_inputs(const InputsOptions& options) {
  std::vector<std::string> left_out;
  const auto all = open_all(left_out);
  catch_stop_signals();
  const std::int64_t begun_ns = monotonic_ns();
  const auto passed_s = [begun_ns] { return static_cast<double>(monotonic_ns() - begun_ns) * 1e-9; };
  double said_s = 0.0;
  while (!all.empty() && !stop_requested() && passed_s() < options.seconds) {
    for (const auto& watched : all) watched->read();
    if (!options.json && passed_s() - said_s > 0.5) {
      said_s = passed_s();
      for (const auto& watched : all) fmt::print("{}: {}\n", watched->path, now(*watched));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  print_inputs(options, all, left_out, std::max(passed_s(), 1e-3));
  return 0;
}

void add_inputs_parameters(InputsOptions& options, Settings& settings) {
  settings.add("seconds", options.seconds, {.min = 0, .max = 3600, .unit = "s"}, "how long they are watched");
  settings.add("json", options.json, "for machines");
}

}  // namespace

void add_inputs_command(Program& program) {
  program.add("inputs", "Lists gamepads, pens, SpaceMice and pedals at this computer, with what they say now",
              InputsOptions{}, add_inputs_parameters, watch_inputs);
}

}  // namespace telekerf::inspect
