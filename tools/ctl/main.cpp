// SPDX-License-Identifier: Apache-2.0
// telekerf-ctl WHAT [VALUE]: what an operator says to a running cell.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/network_watch.h"
#include "common/bus/roll_call.h"
#include "common/bus/send_event.h"
#include "common/bus/send_stop.h"
#include "common/runtime/program.h"
#include "common/runtime/say.h"
#include "netem/drivers/netem_flags.h"

namespace telekerf {
namespace {

struct Options {
  BusFlags bus;
  netem::NetemFlags netem;
  EventMessage event;
  std::vector<std::string> roles = {"master"};  ///< who has to take it up
};

/// Who speaks without keys says so, beside what is asked of it.
void say_unsecured(const Bus& bus) {
  if (bus.settings().security.empty()) write_line(stderr, fmt::format("ctl: {}", bus.protection()));
}

int run(const Options& options) {
  BusSettings bus_settings = options.bus.bus_settings(Site::kOperator, "ctl");
  bus_settings.receive_filter = options.netem.emulator(bus_settings.site);
  Bus bus(bus_settings);
  say_unsecured(bus);
  fmt::print("taken up by {} of cell '{}'\n", fmt::join(tell(bus, options.event, options.roles), ", "),
             bus.settings().cell);
  return 0;
}

struct StopOptions {
  BusFlags bus;
  netem::NetemFlags netem;
  std::string as = "operator";
  std::string reason;
};

/// Neither looks around first nor asks for a place in the cell: a stop waits for nobody.
BusSettings at_once(const StopOptions& options) {
  BusSettings settings = options.bus.bus_settings(Site::kOperator, "ctl");
  settings.receive_filter = options.netem.emulator(settings.site);
  settings.discovery_wait = std::chrono::milliseconds(0);
  return settings;
}

int stop(const StopOptions& options) {
  Bus bus(at_once(options));
  const std::vector<std::string> told = send_stop(bus, options.as, options.reason);
  say_unsecured(bus);
  fmt::print("stopped: {} confirmed it\n", fmt::join(told, ", "));
  return 0;
}

int clear(const StopOptions& options) {
  Bus bus(at_once(options));
  say_unsecured(bus);
  fmt::print("cleared: {} confirmed it; engage anew to go on\n",
             fmt::join(clear_stop(bus, options.as), ", "));
  return 0;
}

struct LookOptions : StopOptions {
  double wait_s = 2.0;
  bool json = false;
};

/// An address of this computer's own needs no number.
std::string host_of(const std::string& address) {
  return address.starts_with("127.") || network_addresses().contains(address) ? "this computer" : address;
}

std::string clock_of(const RollCall::Present& one) {
  return one.clock_ahead_s ? fmt::format("{:+.0f} ms", *one.clock_ahead_s * 1e3) : "not told";
}

void print_json(const std::vector<RollCall::Present>& present) {
  auto all = nlohmann::ordered_json::array();
  for (const RollCall::Present& one : present) {
    all.push_back({{"role", one.who.role},
                   {"name", one.who.name},
                   {"host", one.address},
                   {"version", one.who.version},
                   {"contract", one.who.contract}});
    if (one.clock_ahead_s) all.back()["clock_ahead_s"] = *one.clock_ahead_s;
  }
  fmt::print("{}\n", all.dump(2));
}

int look(const LookOptions& options) {
  Bus bus(at_once(options));
  say_unsecured(bus);
  const RollCall roll_call(bus);
  std::this_thread::sleep_for(std::chrono::duration<double>(options.wait_s));
  const auto present = roll_call.present();
  if (options.json) {
    print_json(present);
  } else if (!present.empty()) {
    fmt::print("{:<10}{:<16}{:<18}{:<12}{}\n", "role", "name", "host", "version", "clock");
    for (const RollCall::Present& one : present)
      fmt::print(
          "{:<10}{:<16}{:<18}{:<12}{}{}\n", one.who.role, one.who.name, host_of(one.address), one.who.version,
          clock_of(one),
          one.who.contract == bus.settings().contract ? "" : "  another contract: install the same version");
  } else {
    std::set<std::string> cells;
    for (const PresenceMessage& other : bus.elsewhere()) cells.insert(other.cell);
    const std::string unheard = bus.unheard();
    fmt::print("nobody in cell '{}' of domain {}{}{}{}\n", bus.settings().cell, bus.settings().domain,
               cells.empty() ? "" : fmt::format("; there are cells {}", fmt::join(cells, ", ")),
               unheard.empty() ? "" : "; ", unheard);
  }
  return present.empty() ? 1 : 0;
}

void add_who(StopOptions& options, Settings& settings) {
  settings.add("as", options.as, kName, "who says it: a stop is cleared by nobody else");
  options.bus.add_parameters(settings);
  options.netem.add_parameters(settings);
}

void add_stop_parameters(StopOptions& options, Settings& settings) {
  settings.add("reason", options.reason, TextForm{"TEXT"}, "told at both sites");
  add_who(options, settings);
}

void add_look_parameters(LookOptions& options, Settings& settings) {
  settings.add("wait_s", options.wait_s, {.min = 0.1, .max = 60, .unit = "s"}, "listens for this long");
  settings.add("json", options.json, "prints JSON");
  options.bus.add_parameters(settings);
  options.netem.add_parameters(settings);
}

Options saying(EventMessage::Kind kind) {
  Options options;
  options.event.kind = kind;
  return options;
}

void add_parameters(Options& options, Settings& settings) {
  options.bus.add_parameters(settings);
  options.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf

int main(int argc, char** argv) {
  using namespace telekerf;
  using Kind = EventMessage::Kind;
  Program program("telekerf-ctl", "Says something to the processes of a running cell");
  program.add("stop", "Emergency stop: laser off, every robot brakes and holds, until clear-stop",
              StopOptions{}, add_stop_parameters, stop);
  program.add("clear-stop", "Ends an emergency stop; nothing moves before it is engaged anew", StopOptions{},
              add_who, clear);
  program.add("look",
              "Lists who is in the cell: role, name, host, version, and how far its clock is ahead of this "
              "computer's",
              LookOptions{}, add_look_parameters, look);
  program.add("engage", "Lets the slave follow the master", saying(Kind::kEngage), add_parameters, run);
  program.add("disengage", "Lets go of the slave: it holds its pose, laser off", saying(Kind::kDisengage),
              add_parameters, run);
  program.add(
      "beta", "Slave motion = beta x master motion from now on", saying(Kind::kSetBeta),
      [](Options& options, Settings& settings) {
        settings.add("value", options.event.value, {.min = 0.01, .max = 10}, "the new scale").as_argument();
        add_parameters(options, settings);
      },
      run);
  program.add(
      "stream", "Changes law, estimator or codec of the command stream, between two engagements",
      saying(Kind::kSetStream),
      [](Options& options, Settings& settings) {
        settings
            .add("what", options.event.text,
                 TextForm{.form = "TEXT", .complaint = [](const std::string&) { return std::string(); }},
                 "'law WORD', 'estimator WORD', 'codec WORD', 'block N', 'keep N' or 'redundancy N', as the "
                 "master's options")
            .as_argument();
        add_parameters(options, settings);
      },
      run);
  Options take = saying(Kind::kTakeContour);
  take.roles = {"master", "slave"};
  program.add(
      "take-contour", "Works on the contour that waits, in place of the one in force", take,
      [](Options& options, Settings& settings) {
        settings
            .add("id", options.event.value, {.min = 1, .max = 4294967295.0},
                 "its number, as master and slave have said it")
            .as_argument();
        add_parameters(options, settings);
      },
      run);
  Options zoom = saying(Kind::kSetZoom);
  zoom.roles = {"vision"};
  program.add(
      "zoom", "Moves the imaging unit's magnification; its focus and the contour's scale follow", zoom,
      [](Options& options, Settings& settings) {
        settings.add("value", options.event.value, {.min = 0, .max = 1}, "share of the axis' travel")
            .as_argument();
        add_parameters(options, settings);
      },
      run);
  Options refocus = saying(Kind::kRefocus);
  refocus.roles = {"vision"};
  program.add("refocus", "The imaging unit searches its focus anew", refocus, add_parameters, run);
  Options choose = saying(Kind::kLook);
  choose.roles = {"vision"};
  program.add(
      "choose", "Says what is meant in vision's picture; the contour that comes of it waits to be taken",
      choose,
      [](Options& options, Settings& settings) {
        settings
            .add("what", options.event.text,
                 TextForm{.form = "TEXT", .complaint = [](const std::string&) { return std::string(); }},
                 "'at X,Y', 'start X,Y', 'end X,Y' (metres on the workpiece), 'mode WORD', 'level SHARE' or "
                 "anew")
            .as_argument();
        add_parameters(options, settings);
      },
      run);
  return program.run(argc, argv);
}
