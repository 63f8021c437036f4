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

constexpr std::size_t kMaxStages = 64;

void read_events(const ConfigFile& file, Profile& profile) {
  const std::size_t count = file.array_size("event");
  if (count > kMaxEvents) throw StartupError(fmt::format("{}: more than {} events", file.name(), kMaxEvents));
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = fmt::format("event.{}.", i);
    Event event;
    event.first_s = file.number_or(at + "first_s", 0.0, {0.0, 1e6});
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
    if (event.add_delay_max_s == 0 && event.loss == 0)
      file.refuse(at + "loss", "an event adds delay or loses packets");
    const auto direction = file.choice_or(at + "direction", "both", {"both", "forward", "backward"});
    if (direction != "backward") profile.forward.events.push_back(event);
    if (direction != "forward") profile.backward.events.push_back(event);
  }
}

DirectionProfile read_direction(const ConfigFile& file, const std::string& name, const std::string& folder) {
  DirectionProfile direction;
  const Section base(file, {name + ".", "both."});
  const auto recording = [&](const char* key, const std::string& trace) {
    const fs::path path = fs::path(folder) / trace;
    if (!fs::is_regular_file(path)) base.refuse(key, fmt::format("there is no trace '{}'", path.string()));
    return std::make_shared<Recording>(load_recording(path.string()));
  };
  const std::string trace = base.text("trace", "");
  const std::string loss_trace = base.text("loss_trace", "");
  direction.stages.front().conditions = read_conditions(base);
  if (direction.stages.front().conditions.loss.model == LossModel::kTrace) {
    if (loss_trace.empty()) base.refuse("loss_trace", "loss_model = \"trace\" needs a trace file");
    direction.recording = recording("loss_trace", loss_trace);
    direction.loss_only = true;
  }
  if (base.has("trace")) {
    for (const char* key : {"delay_ms", "distribution", "loss_model", "loss", "order", "tcp_like",
                            "duplicate", "corrupt", "rate_kbit_per_s", "slot_ms"}) {
      if (base.has(key)) base.refuse(key, "a trace already decides the fate of every packet");
    }
    if (file.array_size("stage") + file.array_size("event") > 0) {
      base.refuse("trace", "a trace knows neither stages nor events");
    }
    direction.recording = recording("trace", trace);
  }
  std::vector<std::string> tables{name + ".", "both."};
  for (std::size_t i = 0; i < file.array_size("stage"); ++i) {
    const std::string at = fmt::format("stage.{}.", i);
    Stage stage;
    stage.from_s = file.number(at + "from_s", {0.0, 1e6});
    if (stage.from_s <= direction.stages.back().from_s)
      file.refuse(at + "from_s", "stages must ascend from above 0");
    tables.insert(tables.begin(), {at + name + ".", at + "both."});
    stage.conditions = read_conditions(Section(file, tables));
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
      throw StartupError(fmt::format("{}: has neither [{}] nor [both]", file.name(), direction));
    }
  }
  if (file.array_size("stage") > kMaxStages) {
    throw StartupError(fmt::format("{}: more than {} stages", file.name(), kMaxStages));
  }
  profile.forward = read_direction(file, "forward", folder);
  profile.backward = read_direction(file, "backward", folder);
  read_events(file, profile);
  file.refuse_unknown();
  return profile;
}

}  // namespace

Profile parse_profile(const std::string& text, const std::string& name, const std::string& folder) {
  return read_profile(ConfigFile(text, name), name, folder);
}

Profile load_profile(const std::string& name_or_path) {
  const fs::path path = find_resource("profiles", name_or_path, ".toml");
  if (path.extension() == ".csv") {
    Profile profile;
    profile.name = path.stem().string();
    profile.description = "recorded trace";
    profile.source = path.string();
    profile.forward.recording = std::make_shared<Recording>(load_recording(path.string()));
    profile.backward.recording = profile.forward.recording;
    return profile;
  }
  return read_profile(ConfigFile(path), path.stem().string(), path.parent_path().string());
}

Profile simple_profile(double rtt_s, double jitter_s, double loss) {
  std::string text = fmt::format("[both]\ndelay_ms = {:.9f}\nloss = {:.9f}\n", rtt_s * 500.0, loss);
  if (jitter_s != 0) text += fmt::format("distribution = \"normal\"\njitter_ms = {:.9f}\n", jitter_s * 1e3);
  return parse_profile(text, "rtt, jitter and loss");
}

}  // namespace telekerf::netem
