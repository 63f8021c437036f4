// SPDX-License-Identifier: Apache-2.0
#include "tools/inspect/run_mcap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/run_folder.h"
#include "common/recording/run_reader.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/mcap_file.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

/// Little-endian CDR with its four-byte head; alignment counts from behind that.
struct Cdr {
  std::string bytes{"\x00\x01\x00\x00", 4};
  template <typename T>
  void put(T value) {
    while ((bytes.size() - 4) % sizeof value != 0) bytes += '\0';
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
};

const char* type_of(ColumnKind kind) {
  switch (kind) {
    case ColumnKind::kCount:
      return "uint64";
    case ColumnKind::kInteger:
      return "int32";
    case ColumnKind::kYesNo:
      return "bool";
    case ColumnKind::kNumber:
      break;
  }
  return "float64";
}

std::string fields_of(const SeriesSchema& schema) {
  std::string text;
  for (const SeriesColumn& column : schema.columns) {
    text += fmt::format("{} {}", type_of(column.kind), column.name);
    if (!column.unit.empty() || !column.sentence.empty())
      text += fmt::format("  # {}{}{}", column.unit,
                          column.unit.empty() || column.sentence.empty() ? "" : ", ", column.sentence);
    text += '\n';
  }
  return text;
}

std::string cdr_of(const SeriesSchema& schema, const double* row) {
  Cdr cdr;
  for (std::size_t c = 0; c < schema.width(); ++c) {
    switch (schema.columns[c].kind) {
      case ColumnKind::kCount:
        cdr.put(static_cast<std::uint64_t>(row[c]));
        break;
      case ColumnKind::kInteger:
        cdr.put(static_cast<std::int32_t>(row[c]));
        break;
      case ColumnKind::kYesNo:
        cdr.put(static_cast<std::uint8_t>(row[c] != 0.0));
        break;
      case ColumnKind::kNumber:
        cdr.put(row[c]);
    }
  }
  return std::move(cdr.bytes);
}

std::string json_of(const SeriesSchema& schema, const double* row) {
  nlohmann::ordered_json json;
  for (std::size_t c = 0; c < schema.width(); ++c) json[schema.columns[c].name] = row[c];
  return json.dump();
}

/// "master" -> "MasterRow", "in_force" -> "InForceRow".
std::string type_name(const std::string& series) {
  std::string name = "telekerf/msg/";
  bool upper = true;
  for (const char c : series) {
    if (c == '_') {
      upper = true;
    } else {
      name += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      upper = false;
    }
  }
  return name + "Row";
}

constexpr const char* kContourFields =
    "uint32 id\nbool closed\nfloat64[] x_m  # workpiece frame\nfloat64[] y_m\n";

std::string cdr_of(const RunContour& contour) {
  Cdr cdr;
  cdr.put(contour.id);
  cdr.put(static_cast<std::uint8_t>(contour.closed));
  for (int axis : {0, 1}) {
    cdr.put(static_cast<std::uint32_t>(contour.points_m.size()));
    for (const Vec2& point : contour.points_m) cdr.put(point[axis]);
  }
  return std::move(cdr.bytes);
}

/// A message that waits for its turn.
struct Waiting {
  std::uint64_t time_ns;
  std::uint16_t channel;
  const SeriesSchema* schema;  ///< of `row`; null: `text` is it
  const double* row;
  std::string text;
};

/// From a process' clock to nanoseconds since 1970.
struct Dates {
  double offset_s = 0.0;  ///< of its clock against the master's
  std::int64_t utc_at_zero_ns = 0;
  std::uint64_t operator()(double t_s) const {
    return static_cast<std::uint64_t>(
        std::max<std::int64_t>(std::llround((t_s - offset_s) * 1e9) + utc_at_zero_ns, 0));
  }
};

/// Whose recordings are exported, the master's first.
struct Recorded {
  const char* role;
  bool at_workpiece;  ///< by the clock there
};
constexpr Recorded kRecorded[] = {
    {"master", false}, {"console", false}, {"slave", true}, {"vision", true}, {"machine", true}};

class Export {
 public:
  explicit Export(const fs::path& file) : file_(file) {}

  void add(const RunReader& reader, const Dates& dates) {
    const RunIdentity& identity = reader.identity();
    for (const auto& series : reader.series()) {
      data_.push_back(std::make_unique<SeriesData>(*reader.data(series.schema.name)));
      const SeriesData& data = *data_.back();
      const bool json = data.schema.name == "telemetry";
      const std::uint16_t schema =
          json ? file_.add_schema("telekerf.Telemetry", "jsonschema", R"({"type":"object"})")
               : file_.add_schema(type_name(data.schema.name), "ros2msg", fields_of(data.schema));
      const std::string topic = data.schema.name == identity.role ? "rows" : data.schema.name;
      const std::uint16_t channel =
          file_.add_channel("/" + identity.role + "/" + topic, schema, json ? "json" : "cdr", {});
      const auto time = std::find_if(data.schema.columns.begin(), data.schema.columns.end(),
                                     [](const SeriesColumn& column) { return column.name == "t_s"; });
      if (time == data.schema.columns.end()) continue;
      const auto t = static_cast<std::size_t>(time - data.schema.columns.begin());
      for (std::size_t n = 0; n < data.rows(); ++n)
        messages_.push_back({dates(data.row(n)[t]), channel, &data.schema, data.row(n), {}});
      if (json) json_channel_.push_back(channel);
    }
    const std::uint16_t said = file_.add_channel(
        "/" + identity.role + "/events",
        file_.add_schema("telekerf.Event", "jsonschema", R"({"type":"object"})"), "json", {});
    for (const RunEvent& event : reader.events()) {
      const nlohmann::ordered_json json{
          {"kind", event.kind}, {"tick", event.tick}, {"value", event.value}, {"text", event.text}};
      messages_.push_back({dates(event.t_s), said, nullptr, nullptr,
                           json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)});
    }
    const std::uint16_t contours =
        file_.add_channel("/" + identity.role + "/contour",
                          file_.add_schema("telekerf/msg/Contour", "ros2msg", kContourFields), "cdr", {});
    for (const RunContour& contour : reader.contours())
      messages_.push_back({dates(contour.t_s), contours, nullptr, nullptr, cdr_of(contour)});
    McapFile::Words words = identity.words;
    for (const auto& [name, figure] : identity.figures) words[name] = fmt::format("{}", figure);
    words["settings"] = identity.settings;
    words["cell"] = identity.cell;
    words["created_utc"] = identity.created_utc;
    metadata_.emplace_back(identity.role, std::move(words));
  }

  void finish() {
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Waiting& a, const Waiting& b) { return a.time_ns < b.time_ns; });
    for (const Waiting& message : messages_) {
      const bool json =
          std::find(json_channel_.begin(), json_channel_.end(), message.channel) != json_channel_.end();
      file_.add_message(message.channel, message.time_ns,
                        message.schema == nullptr ? message.text
                        : json                    ? json_of(*message.schema, message.row)
                                                  : cdr_of(*message.schema, message.row));
    }
    for (const auto& [role, words] : metadata_) file_.add_metadata(role, words);
    file_.finish();
  }

 private:
  McapFile file_;
  std::vector<std::unique_ptr<SeriesData>> data_;
  std::vector<Waiting> messages_;
  std::vector<std::uint16_t> json_channel_;
  std::vector<std::pair<std::string, McapFile::Words>> metadata_;
};

}  // namespace

void write_mcap(const fs::path& file, std::span<const fs::path> folders) {
  Export out(file);
  std::optional<Dates> operators, workpieces;  // by the master, which knows both clocks
  bool any = false;
  for (const Recorded& recorded : kRecorded) {
    const auto found = recording_of(recorded.role, folders);
    if (!found) continue;
    any = true;
    const RunReader reader(*found, RunReader::Check::kHead);
    const std::int64_t utc_at_zero_ns = reader.identity().utc_at_zero_ns;
    if (recorded.role == std::string_view("master")) {
      const auto offset = reader.identity().figures.find("clock_offset_us");
      operators = {0.0, utc_at_zero_ns};
      workpieces = {offset == reader.identity().figures.end() ? 0.0 : 1e-6 * offset->second, utc_at_zero_ns};
    }
    out.add(reader, (recorded.at_workpiece ? workpieces : operators).value_or(Dates{0.0, utc_at_zero_ns}));
  }
  if (!any) throw input_error(fmt::format("{}: holds no recording of a run", folders.front().string()));
  out.finish();
}

}  // namespace telekerf::inspect
