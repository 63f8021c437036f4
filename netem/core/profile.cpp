// SPDX-License-Identifier: Apache-2.0
#include "netem/core/profile.h"

#include <fmt/format.h>

#include <filesystem>

#include "common/runtime/config.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"
#include "netem/core/conditions.h"
#include "netem/core/section.h"
#include "netem/core/trace.h"

namespace telekerf::netem {
namespace fs = std::filesystem;
namespace {

/// Any number above 0 that the word alone decides (FNV-1a).
std::uint64_t coupling_of(const std::string& word) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : word) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash | 1;
}

void read_events(const ConfigFile& file, Profile& profile) {
  const std::size_t count = file.array_size("event");
  if (count > kMaxEvents)
    throw configuration_error(fmt::format("{}: more than {} events", file.name(), kMaxEvents));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = fmt::format("event.{}.", i);
    Event event;
    event.first_s = file.number_or(at + "first_s", 0.0, {-1e6, 1e6});
    event.every_s = file.number_or(at + "every_s", 0.0, {0.01, 1e6});
    event.duration_s = file.number(at + "duration_ms", {0.01, 1e7}) * kMillisecond_s;
    if (event.every_s > 0 && event.duration_s > event.every_s)
      file.refuse(at + "duration_ms", "must fit every_s");
    if (file.has(at + "add_delay_ms")) {
      const auto range = file.numbers(at + "add_delay_ms", 2, kDelay_ms);
      if (range[0] > range[1]) file.refuse(at + "add_delay_ms", "is written as [least, most]");
      event.add_delay_min_s = range[0] * kMillisecond_s;
      event.add_delay_max_s = range[1] * kMillisecond_s;
    }
    event.loss = file.number_or(at + "loss", 0.0, kProbability);
    event.hold = file.boolean_or(at + "hold", false);
    if (event.hold && file.has(at + "add_delay_ms"))
      file.refuse(at + "add_delay_ms",
                  "an event that holds packets to its end says already how long they wait");
    if (event.add_delay_max_s == 0 && event.loss == 0 && !event.hold)
      file.refuse(at + "loss", "an event adds delay, holds packets or loses them");
    if (file.has(at + "coupled")) {
      const std::string coupled = file.text(at + "coupled");
      if (coupled.empty()) file.refuse(at + "coupled", "is a word that several events have in common");
      if (event.add_delay_max_s == 0)
        file.refuse(at + "coupled", "needs add_delay_ms, which is what is drawn");
      event.coupling = coupling_of(coupled);
    }
    const auto direction = file.choice_or(at + "direction", "both", {"both", "forward", "backward"});
    if (direction != "backward") profile.forward.events.push_back(event);
    if (direction != "forward") profile.backward.events.push_back(event);
  }
}

DirectionProfile read_direction(const ConfigFile& file, const std::string& name, const std::string& folder) {
  DirectionProfile direction;
  Section section(file, "both.", name + ".");
  const auto path_of = [&](const char* key) {
    const fs::path path = fs::path(folder) / section.text(key, "");
    if (!fs::is_regular_file(path)) section.refuse(key, fmt::format("there is no trace '{}'", path.string()));
    return path.string();
  };
  direction.stages.front().conditions = read_conditions(section);
  if (direction.stages.front().conditions.loss.model == LossModel::kTrace) {
    if (!section.has("loss_trace")) section.refuse("loss_trace", "loss_model = \"trace\" needs a trace file");
    direction.recording = std::make_shared<Recording>(load_recording(path_of("loss_trace")));
    direction.loss_only = true;
  }
  if (section.has("rate_trace"))
    direction.rate_trace = std::make_shared<RateTrace>(load_rate_trace(path_of("rate_trace")));
  if (section.has("trace")) {
    for (const char* key : {"delay_ms", "distribution", "loss_model", "loss", "order", "tcp_like",
                            "duplicate", "corrupt", "rate_kbit_per_s", "rate_trace", "slot_ms"}) {
      if (section.has(key)) section.refuse(key, "a trace already decides the fate of every packet");
    }
    if (file.array_size("stage") + file.array_size("event") > 0) {
      section.refuse("trace", "a trace knows neither stages nor events");
    }
    direction.recording = std::make_shared<Recording>(load_recording(path_of("trace")));
  }
  direction.trace_end = section.choice("trace_end", TraceEnd::kLose, kTraceEnds);
  if (section.has("trace_end") && !direction.recording && !direction.rate_trace)
    section.refuse("trace_end", "needs trace, loss_trace or rate_trace");
  for (std::size_t i = 0; i < file.array_size("stage"); ++i) {
    const std::string at = fmt::format("stage.{}.", i);
    Stage stage;
    stage.from_s = file.number(at + "from_s", {0.0, 1e6});
    if (stage.from_s <= direction.stages.back().from_s)
      file.refuse(at + "from_s", "stages must ascend from above 0");
    section.override_by(at + "both.", at + name + ".");
    stage.conditions = read_conditions(section);
    if (stage.conditions.loss.model == LossModel::kTrace && !direction.loss_only) {
      file.refuse(at + "from_s", "loss_model = \"trace\" must already stand at the beginning");
    }
    direction.stages.push_back(stage);
  }
  return direction;
}

Profile read_profile(const ConfigFile& file, const std::string& name, const std::string& folder) {
  Profile profile;
  profile.name = name;
  profile.description = file.text_or("description", "");
  profile.source = file.text_or("source", "");
  for (const char* direction : {"forward", "backward"}) {
    if (!file.has("both") && !file.has(direction)) {
      throw configuration_error(fmt::format("{}: has neither [{}] nor [both]", file.name(), direction));
    }
  }
  profile.forward = read_direction(file, "forward", folder);
  profile.backward = read_direction(file, "backward", folder);
  read_events(file, profile);
  file.refuse_unknown();
  return profile;
}

Profile recorded_packets(const fs::path& path) {
  Profile profile;
  profile.name = path.stem().string();
  profile.description = "recorded trace";
  profile.source = path.string();
  profile.forward.recording = std::make_shared<Recording>(load_recording(path.string()));
  profile.backward.recording = profile.forward.recording;
  return profile;
}

/// Either name stands for both files. The terminal is taken to be the slave's: what goes down goes forward.
Profile recorded_rates(const fs::path& path) {
  constexpr std::int64_t kQueue_bytes = 100 * kOpportunity_bytes;
  Profile profile;
  profile.name = path.stem().string();
  profile.description = "recorded rates";
  profile.source = path.string();
  for (auto [direction, extension] : {std::pair{&profile.forward, ".down"}, {&profile.backward, ".up"}}) {
    const fs::path file = fs::path(path).replace_extension(extension);
    direction->rate_trace = std::make_shared<RateTrace>(load_rate_trace(file.string()));
    direction->stages.front().conditions.queue_bytes = kQueue_bytes;
  }
  return profile;
}

}  // namespace

Profile parse_profile(const std::string& text, const std::string& name, const std::string& folder) {
  return read_profile(ConfigFile(text, name), name, folder);
}

Profile load_profile(const std::string& name_or_path) {
  const fs::path path = find_resource("profiles", name_or_path, ".toml");
  if (path.extension() == ".csv") return recorded_packets(path);
  if (path.extension() == ".up" || path.extension() == ".down") return recorded_rates(path);
  return read_profile(ConfigFile(path), path.stem().string(), path.parent_path().string());
}

std::string trace_note(const Profile& profile) {
  std::string note;
  for (const auto* direction : {&profile.forward, &profile.backward}) {
    std::int64_t length_ns = 0;
    if (direction->recording) length_ns = recording_length_ns(*direction->recording);
    if (direction->rate_trace) length_ns = direction->rate_trace->at_ns.back();
    if (length_ns == 0) continue;
    note += fmt::format("{}{} is recorded for {:.6g} s, then {}", note.empty() ? "" : "; ",
                        direction == &profile.forward ? "forward" : "backward",
                        static_cast<double>(length_ns) * 1e-9,
                        direction->trace_end == TraceEnd::kRepeat
                            ? "it begins anew"
                            : "nothing gets through (trace_end = \"repeat\" begins it anew)");
  }
  return note;
}

Profile simple_profile(double rtt_s, double jitter_s, double loss) {
  std::string text = fmt::format("[both]\ndelay_ms = {:.9f}\nloss = {:.9f}\n", rtt_s * 500.0, loss);
  if (jitter_s != 0) text += fmt::format("distribution = \"normal\"\njitter_ms = {:.9f}\n", jitter_s * 1e3);
  return parse_profile(text, "rtt, jitter and loss");
}

}  // namespace telekerf::netem
