// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;
namespace {

constexpr const char* kMasterColumns =
    "tick,t_s,tool_x_m,tool_y_m,tool_z_m,hand_x_n,hand_y_n,hand_z_n,constraint_n,guided,engaged,button,"
    "predicted_x_m,predicted_y_m,predicted_z_m,joined,force_tick,slave_force_x_n,slave_force_y_n,"
    "slave_force_z_n,beta";
constexpr const char* kSlaveColumns =
    "tick,t_s,applied_tick,ref_x_m,ref_y_m,ref_z_m,tool_x_m,tool_y_m,tool_z_m,laser_w,interlock,settled,"
    "force_x_n,force_y_n,force_z_n";
constexpr const char* kContourColumns = "x_m,y_m";

std::vector<std::vector<double>> read_table(const fs::path& path, std::string_view columns) {
  std::ifstream in(path);
  if (!in)
    throw StartupError(
        fmt::format("{}: cannot be read; is this the folder of a finished run?", path.string()));
  const auto width = static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ',') + 1);
  std::string line;
  if (!std::getline(in, line) || line != columns) {
    throw StartupError(fmt::format("{}: line 1 must be '{}'", path.string(), columns));
  }
  std::vector<std::vector<double>> rows;
  for (int number = 2; std::getline(in, line); ++number) {
    std::vector<double> row;
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at < end) {
      double value = 0;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc()) break;
      row.push_back(value);
      at = next < end && *next == ',' ? next + 1 : end;
    }
    if (row.size() != width) {
      throw StartupError(fmt::format("{}: line {} must hold {} numbers", path.string(), number, width));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void append(std::string& text, std::initializer_list<double> values) {
  bool first = true;
  for (const double value : values) {
    fmt::format_to(std::back_inserter(text), "{}{}", first ? "" : ",", value);
    first = false;
  }
  text += '\n';
}

nlohmann::json as_json(const Metrics& figures) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, value] : figures) json[name] = value;
  return json;
}

DriveRecord read_drive(const nlohmann::json& json) {
  const nlohmann::json drive = json.value("drive", nlohmann::json::object());
  return {drive.value("name", DriveRecord{}.name), drive.value("tool", "true") == "true"};
}

nlohmann::json read_json(const fs::path& path) {
  std::ifstream in(path);
  if (!in)
    throw StartupError(
        fmt::format("{}: cannot be read; is this the folder of a finished run?", path.string()));
  auto json = nlohmann::json::parse(in, nullptr, false);
  if (!json.is_object()) throw StartupError(fmt::format("{}: is not a JSON object", path.string()));
  return json;
}

void read_figures(const nlohmann::json& json, Metrics& figures) {
  const nlohmann::json named = json.value("figures", nlohmann::json::object());
  for (const auto& [name, value] : named.items()) {
    if (value.is_number()) figures[name] = value.get<double>();
  }
}

}  // namespace

Metadata words_of(const DriveRecord& drive) {
  return {{"name", drive.name}, {"tool", drive.true_tool ? "true" : "measured"}};
}

void add_figures(const LoopStatistics& loop, Metrics& figures) {
  figures["rate_hz"] = loop.rate_hz;
  figures["slack_p50_us"] = loop.slack_p50_us;
  figures["slack_p99_us"] = loop.slack_p99_us;
  figures["slack_min_us"] = loop.slack_min_us;
  figures["late_p50_us"] = loop.late_p50_us;
  figures["late_p99_us"] = loop.late_p99_us;
  figures["late_max_us"] = loop.late_max_us;
  figures["overruns"] = static_cast<double>(loop.overruns);
  figures["real_time"] = loop.real_time ? 1.0 : 0.0;
}

void write_contour(const fs::path& folder, const RunRecord& record) {
  std::string text = std::string(kContourColumns) + "\n";
  for (const auto& point : record.contour_m) append(text, {point[0], point[1]});
  write_atomically(folder / "contour.csv", text);
  write_json(folder / "contour.json", nlohmann::json{{"closed", record.contour_closed}});
}

void write_master(const fs::path& folder, const RunRecord& record) {
  std::string text = std::string(kMasterColumns) + "\n";
  for (const auto& r : record.master) {
    append(text, {static_cast<double>(r.tick),
                  r.t_s,
                  r.tool_m[0],
                  r.tool_m[1],
                  r.tool_m[2],
                  r.hand_n[0],
                  r.hand_n[1],
                  r.hand_n[2],
                  r.constraint_n,
                  double(r.guided),
                  double(r.engaged),
                  double(r.button),
                  r.predicted_m[0],
                  r.predicted_m[1],
                  r.predicted_m[2],
                  double(r.joined),
                  r.force_tick,
                  r.slave_force_n[0],
                  r.slave_force_n[1],
                  r.slave_force_n[2],
                  r.beta});
  }
  write_atomically(folder / "master.csv", text);
  write_json(folder / "master.json", nlohmann::json{{"figures", as_json(record.master_figures)},
                                                    {"drive", words_of(record.master_drive)},
                                                    {"words", record.words}});
}

void write_slave(const fs::path& folder, const RunRecord& record) {
  std::string text = std::string(kSlaveColumns) + "\n";
  for (const auto& r : record.slave) {
    append(text, {static_cast<double>(r.tick), r.t_s, r.applied, r.ref_m[0], r.ref_m[1], r.ref_m[2],
                  r.tool_m[0], r.tool_m[1], r.tool_m[2], r.laser_w, double(r.interlock), double(r.settled),
                  r.force_n[0], r.force_n[1], r.force_n[2]});
  }
  write_atomically(folder / "slave.csv", text);
  write_json(folder / "slave.json", nlohmann::json{{"figures", as_json(record.slave_figures)},
                                                   {"drive", words_of(record.slave_drive)}});
}

RunRecord read_run(const fs::path& folder) {
  RunRecord record;
  for (const auto& row : read_table(folder / "contour.csv", kContourColumns)) {
    record.contour_m.push_back({row[0], row[1]});
  }
  record.contour_closed = read_json(folder / "contour.json").value("closed", true);
  for (const auto& v : read_table(folder / "master.csv", kMasterColumns)) {
    record.master.push_back({static_cast<std::uint64_t>(v[0]),
                             v[1],
                             {v[2], v[3], v[4]},
                             {v[5], v[6], v[7]},
                             v[8],
                             v[9] != 0,
                             v[10] != 0,
                             v[11] != 0,
                             {v[12], v[13], v[14]},
                             v[15] != 0,
                             v[20],
                             v[16],
                             {v[17], v[18], v[19]}});
  }
  for (const auto& v : read_table(folder / "slave.csv", kSlaveColumns)) {
    record.slave.push_back({static_cast<std::uint64_t>(v[0]),
                            v[1],
                            v[2],
                            {v[3], v[4], v[5]},
                            {v[6], v[7], v[8]},
                            v[9],
                            static_cast<int>(v[10]),
                            v[11] != 0,
                            {v[12], v[13], v[14]}});
  }
  const auto master = read_json(folder / "master.json");
  read_figures(master, record.master_figures);
  record.master_drive = read_drive(master);
  const nlohmann::json words = master.value("words", nlohmann::json::object());
  for (const auto& [name, value] : words.items()) {
    if (value.is_string()) record.words[name] = value.get<std::string>();
  }
  const auto slave = read_json(folder / "slave.json");
  read_figures(slave, record.slave_figures);
  record.slave_drive = read_drive(slave);
  return record;
}

}  // namespace telekerf
