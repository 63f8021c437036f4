// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_record.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;
namespace {

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
    throw input_error(
        fmt::format("{}: cannot be read; is this the folder of a finished run?", path.string()));
  auto json = nlohmann::json::parse(in, nullptr, false);
  if (!json.is_object()) throw input_error(fmt::format("{}: is not a JSON object", path.string()));
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

void refuse_record_folder(const std::string& option, const fs::path& folder, const std::string& site) {
  refuse_unwritable(option, folder);
  for (const char* extension : {".json", ".h5"}) {
    std::error_code ignored;
    if (fs::exists(folder / (site + extension), ignored)) {
      throw environment_error(
          fmt::format("{} {}: holds the record of another run ({}{}); name another folder", option,
                      folder.string(), site, extension));
    }
  }
}

void write_contour(const fs::path& folder, const RunRecord& record) {
  write_atomically(folder / "contour.csv", csv_of<Vec2>(contour_columns(), record.contour_m));
  nlohmann::json json{{"closed", record.contour_closed}};
  for (std::size_t n = 0; n < record.earlier.size(); ++n) {
    const EarlierContour& earlier = record.earlier[n];
    const std::string file = fmt::format("contour-{}.csv", n + 1);
    write_atomically(folder / file, csv_of<Vec2>(contour_columns(), earlier.points_m));
    json["earlier"].push_back(
        {{"file", file}, {"closed", earlier.closed}, {"until_tick", earlier.until_tick}});
  }
  write_json(folder / "contour.json", json);
}

void write_master(const fs::path& folder, const RunRecord& record) {
  write_atomically(folder / "master.csv", csv_of<MasterRow>(master_columns(), record.master));
  write_json(folder / "master.json", nlohmann::json{{"figures", as_json(record.master_figures)},
                                                    {"drive", words_of(record.master_drive)},
                                                    {"words", record.words}});
}

void write_slave(const fs::path& folder, const RunRecord& record) {
  write_atomically(folder / "slave.csv", csv_of<SlaveRow>(slave_columns(), record.slave));
  write_json(folder / "slave.json", nlohmann::json{{"figures", as_json(record.slave_figures)},
                                                   {"drive", words_of(record.slave_drive)}});
}

void read_master(const fs::path& folder, RunRecord& record) {
  record.contour_m = read_csv(folder / "contour.csv", contour_columns());
  const nlohmann::json contour = read_json(folder / "contour.json");
  record.contour_closed = contour.value("closed", true);
  for (const nlohmann::json& earlier : contour.value("earlier", nlohmann::json::array())) {
    if (!earlier.is_object()) continue;
    record.earlier.push_back({earlier.value("until_tick", std::uint64_t{0}), earlier.value("closed", true),
                              read_csv(folder / earlier.value("file", "contour-1.csv"), contour_columns())});
  }
  record.master = read_csv(folder / "master.csv", master_columns());
  const auto master = read_json(folder / "master.json");
  read_figures(master, record.master_figures);
  record.master_drive = read_drive(master);
  const nlohmann::json words = master.value("words", nlohmann::json::object());
  for (const auto& [name, value] : words.items()) {
    if (value.is_string()) record.words[name] = value.get<std::string>();
  }
}

void read_slave(const fs::path& folder, RunRecord& record) {
  record.slave = read_csv(folder / "slave.csv", slave_columns());
  const auto slave = read_json(folder / "slave.json");
  read_figures(slave, record.slave_figures);
  record.slave_drive = read_drive(slave);
}

}  // namespace telekerf
