// SPDX-License-Identifier: Apache-2.0
// telekerf-console: the operator's web page, and its way into the cell.
#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <random>
#include <string>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/endpoints.h"
#include "common/bus/kept_file.h"
#include "common/bus/process.h"
#include "common/runtime/clock.h"
#include "common/runtime/program.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"
#include "master/console/access.h"
#include "master/console/console.h"
#include "master/console/console_recording.h"
#include "master/console/cut_memory.h"
#include "master/console/hand_line.h"
#include "master/console/web_server.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"

namespace telekerf::master {
namespace {

/// Between two tellings of what is counted, and of what is cut so far.
constexpr std::int64_t kTelling_ns = 1'000'000'000;
constexpr std::int64_t kKeeping_ns = 500'000'000;

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  WebServerSettings web;
  std::string hand;
  std::string as = "operator";
  std::string runs = "out";
  std::string cut_file = "auto";
  CutPower cut;
  double laser_speed_mm_s = 10.0;
  RecordFlags record;
  std::string config;
};

/// Everything that has come from the bus.
struct Ears {
  explicit Ears(Bus& bus)
      : commands(bus), states(bus), contours(bus), previews(bus), telemetry(bus), stops(bus), events(bus) {}
  void hear(Console& console, std::int64_t now_ns) {
    while (auto command = commands.take()) console.cell().hear(*command);
    while (auto state = states.take()) console.cell().hear(*state);
    while (auto contour = contours.take()) console.cell().hear(std::move(contour->value));
    while (auto preview = previews.take()) console.cell().hear(std::move(preview->value));
    while (auto values = telemetry.take()) console.cell().hear(values->value, now_ns);
    while (auto stop = stops.take()) console.stop().hear(stop->value);
    while (auto event = events.take()) console.hear(event->value, now_ns);
  }
  Reader<CommandBlock> commands;
  Reader<StateBlock> states;
  Reader<ContourMessage> contours;
  Reader<PreviewMessage> previews;
  Reader<TelemetryMessage> telemetry;
  Reader<StopMessage> stops;
  Reader<EventMessage> events;
};

int run(Flags& flags) {
  flags.record.validate("console");
  flags.cut.power.speed_m_per_s = 1e-3 * flags.laser_speed_mm_s;
  const bool token_given = !flags.web.token.empty();
  if (!token_given) flags.web.token = new_token();
  if (flags.web.certificate.empty() != flags.web.key.empty())
    throw usage_error("--tls-cert and --tls-key belong together; give both or neither");
  flags.web.runs = {.folder = flags.runs, .inspect = program_beside("telekerf-inspect")};
  BusSettings settings = flags.bus.bus_settings(Site::kOperator, "console");
  const auto emulator = flags.netem.emulator(settings.site);
  settings.receive_filter = emulator;
  const std::string cut_file = path_of(
      {.chosen = flags.cut_file, .flag = "--cut-file", .what = "what is cut so far", .ending = ".cut"}, settings);
  Console console({.cell = settings.cell,
                   .source = flags.as,
                   .token = flags.web.token,
                   .profiles = shipped_names("profiles", ".toml"),
                   .epoch = settings.epoch,
                   .cut = flags.cut});

  boost::asio::io_context context(1);
  std::function<void()> deliver = [] {};
  // The port is asked for before the cell is: who cannot serve need not knock.
  WebServer web(context, flags.web, console, [&deliver] { deliver(); });
  const UdpAddress master =
      flags.hand.empty() ? UdpAddress{"127.0.0.1", web.port()} : udp_address(flags.hand);
  HandLine hand(context, master, [&](const UdpHandAnswer& answer) {
    console.hear(answer);
    web.pump();
  });

  Process process(settings, "console", nullptr);
  Ears ears(process.bus());
  Writer<EventMessage> events(process.bus());
  Writer<StopMessage> stops(process.bus());
  const netem::NetemSwitch netem_switch(process.bus(), emulator);
  Writer<TelemetryMessage> telemetry(process.bus());
  CutMemory memory(cut_file, [&](const std::string& sentence) { process.status().say(sentence); });
  if (auto before = memory.found()) console.cell().remember(std::move(*before));
  ConsoleRecording recording(
      flags.record, flags.netem.with_network(run_identity(settings, "telekerf-console", flags.config)),
      process.status());
  deliver = [&] {
    const std::int64_t now_ns = monotonic_ns();
    if (console.stop().due(now_ns)) {
      if (const auto stop = console.stop().step(process.bus().others(), now_ns)) {
        stops.write(*stop);
        recording.sent(*stop);
      }
    }
    const Console::Outbox outbox = console.take_outbox();
    for (const UdpHandFrame& frame : outbox.hand) {
      hand.send(frame);
      recording.sent(frame);
    }
    for (const EventMessage& event : outbox.events) {
      events.write(event);
      recording.sent(event);
    }
  };

  const auto figures = [&] {
    Metrics all = web.figures();
    netem_switch.add_figures(all);
    return all;
  };
  std::int64_t told_ns = 0, kept_ns = 0;
  const auto tell = [&](std::int64_t now_ns) {
    if (const std::string refused = web.due(now_ns); !refused.empty()) process.status().say(refused);
    if (now_ns - kept_ns >= kKeeping_ns) {
      kept_ns = now_ns;
      if (const auto cut = console.cell().news_of_cut()) memory.keep(*cut);
    }
    if (now_ns - told_ns < kTelling_ns) return;
    told_ns = now_ns;
    const Metrics all = figures();
    telemetry.write({"console", static_cast<std::uint64_t>(now_ns / kTelling_ns), {all.begin(), all.end()}});
  };

  boost::asio::steady_timer timer(context);
  std::function<void()> step = [&] {
    if (stop_requested() || process.ended()) return context.stop();
    process.alive();
    const std::int64_t now_ns = monotonic_ns();
    ears.hear(console, now_ns);
    console.step(now_ns);
    deliver();
    web.pump();
    tell(now_ns);
    // What the bus has brought is looked at on a grid, none of which is made up for; pages and the master's answers are
    // served as they come.
    const auto now = std::chrono::steady_clock::now();
    timer.expires_at(std::max(timer.expiry() + std::chrono::nanoseconds(console.pause_ns()), now));
    timer.async_wait([&step](const boost::system::error_code&) { step(); });
  };
  process.status().say(web.address());
  const std::string warning = warning_of(flags.web.bind, !flags.web.certificate.empty(), token_given);
  if (!warning.empty()) process.status().say(warning);
  step();
  context.run();
  deliver = [] {};
  if (const auto cut = console.cell().news_of_cut()) memory.keep(*cut);
  recording.close(figures());
  process.refuse_ended();
  recording.refuse_unfinished();
  process.status().say("ended in order");
  return 0;
}

std::string complaint_about_token(const std::string& token) {
  return token.empty() || token.size() >= 8 ? "" : "must have 8 characters or more";
}

void add_parameters(Flags& flags, Settings& settings) {
  settings.add("port", flags.web.port, {.min = 0, .max = 65535}, "where the page is served; 0: any free one");
  settings.add("bind", flags.web.bind, kName, "address of this host at which it is served");
  settings.add(
      "tls_cert", flags.web.certificate, kFile,
      "PEM file: the page is served by https, so that browsers on other hosts give it pens and gamepads");
  settings.add("tls_key", flags.web.key, kFile, "PEM file with the certificate's key");
  settings.add("host_name", flags.web.name, kName, "by which the page may be asked for, beside addresses");
  settings.add(
      "token", flags.web.token, TextForm{.form = "TEXT", .complaint = complaint_about_token},
      "a page from another host drives with it, behind # in its address; without: a new one each time");
  settings.add(
      "hand", flags.hand,
      TextForm{.form = "HOST:PORT",
               .complaint =
                   [](const std::string& text) { return text.empty() ? std::string() : validate_udp(text); }},
      "where the master's --hand browser listens; without: 127.0.0.1 and the page's port");
  settings.add("as", flags.as, kName, "who stops from the page: a stop is cleared by nobody else");
  settings.add("runs", flags.runs, kFolder,
               "whose folders are the recorded runs that the page lists and plays");
  settings.add("cut_file", flags.cut_file, kept_file_form(), "keeps what is cut so far over a restart of this process");
  settings.add("laser_w", flags.cut.laser_w, {.min = 0, .max = 1000, .unit = "W"},
               "as the slave's, for the depth that the page tells");
  settings.add("laser_speed_mm_s", flags.laser_speed_mm_s, {.min = 0.5, .max = 200, .unit = "mm/s"},
               "as the slave's, likewise");
  flags.record.add_parameters(settings);
  flags.bus.add_parameters(settings);
  flags.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf::master

int main(int argc, char** argv) {
  using namespace telekerf::master;
  return telekerf::run_program(argc, argv, "telekerf-console",
                               "The operator's console: a web page from which a person cuts", Flags{},
                               add_parameters, run);
}
