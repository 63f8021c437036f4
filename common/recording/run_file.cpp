// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_file.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

#include "common/runtime/clock.h"
#include "common/runtime/version.h"

namespace telekerf {

const char* word_of(RunState state) {
  switch (state) {
    case RunState::kRecording:
      return "recording";
    case RunState::kClosed:
      return "closed";
    case RunState::kRecovered:
      return "recovered";
  }
  return "unknown";
}

void date_now(RunIdentity& identity) {
  const auto now = std::chrono::system_clock::now();
  const auto utc_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count();
  identity.created_utc =
      fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
  identity.utc_at_zero_ns = utc_ns - monotonic_ns();
}

namespace run_file {
namespace {

constexpr std::string_view kKinds[] = {"number", "count", "integer", "yes or no"};

template <std::size_t Length>
void put(char (&to)[Length], const std::string& text) {
  std::memset(to, 0, Length);
  std::memcpy(to, text.data(), std::min(text.size(), Length - 1));
}

template <std::size_t Length>
std::string got(const char (&from)[Length]) {
  return {from, std::find(std::begin(from), std::end(from), '\0')};
}

void insert(const h5::Id& type, const char* name, std::size_t offset, hid_t member) {
  h5::check(H5Tinsert(type.get(), name, offset, member), "a row cannot be described");
}

}  // namespace

h5::Id event_type() {
  h5::Id type(H5Tcreate(H5T_COMPOUND, sizeof(EventCell)), "a row cannot be described");
  insert(type, "time", offsetof(EventCell, t_s), H5T_NATIVE_DOUBLE);
  insert(type, "tick", offsetof(EventCell, tick), H5T_NATIVE_INT64);
  insert(type, "value", offsetof(EventCell, value), H5T_NATIVE_DOUBLE);
  insert(type, "kind", offsetof(EventCell, kind), h5::text_type(sizeof(EventCell::kind)).get());
  insert(type, "text", offsetof(EventCell, text), h5::text_type(sizeof(EventCell::text)).get());
  return type;
}

h5::Id contour_type() {
  h5::Id type(H5Tcreate(H5T_COMPOUND, sizeof(ContourCell)), "a row cannot be described");
  insert(type, "id", offsetof(ContourCell, id), H5T_NATIVE_UINT32);
  insert(type, "closed", offsetof(ContourCell, closed), H5T_NATIVE_UINT32);
  insert(type, "from_tick", offsetof(ContourCell, from_tick), H5T_NATIVE_INT64);
  insert(type, "first", offsetof(ContourCell, first), H5T_NATIVE_UINT64);
  insert(type, "count", offsetof(ContourCell, count), H5T_NATIVE_UINT64);
  insert(type, "time", offsetof(ContourCell, t_s), H5T_NATIVE_DOUBLE);
  insert(type, "metres_per_pixel", offsetof(ContourCell, metres_per_pixel), H5T_NATIVE_DOUBLE);
  insert(type, "deviation", offsetof(ContourCell, deviation_m), H5T_NATIVE_DOUBLE);
  insert(type, "mode", offsetof(ContourCell, mode), h5::text_type(sizeof(ContourCell::mode)).get());
  insert(type, "source", offsetof(ContourCell, source), h5::text_type(sizeof(ContourCell::source)).get());
  return type;
}

EventCell cell_of(const RunEvent& event) {
  EventCell cell{event.t_s, event.tick, event.value, {}, {}};
  put(cell.kind, event.kind);
  put(cell.text, event.text);
  return cell;
}

RunEvent event_of(const EventCell& cell) {
  return {cell.t_s, cell.tick, got(cell.kind), cell.value, got(cell.text)};
}

ContourCell cell_of(const RunContour& contour, std::uint64_t first) {
  ContourCell cell{contour.id,
                   contour.closed ? 1U : 0U,
                   contour.from_tick,
                   first,
                   contour.points_m.size(),
                   contour.t_s,
                   contour.metres_per_pixel,
                   contour.deviation_m,
                   {},
                   {}};
  put(cell.mode, contour.mode);
  put(cell.source, contour.source);
  return cell;
}

RunContour contour_of(const ContourCell& cell) {
  return {cell.id,         cell.closed != 0, cell.from_tick, cell.t_s, cell.metres_per_pixel,
          cell.deviation_m, got(cell.mode),   got(cell.source), {}};
}

void write_identity(hid_t file, const RunIdentity& identity, RunState state) {
  h5::set_text(file, "format", kFormat);
  h5::set_count(file, "format_version", kVersion);
  h5::set_text(file, "state", word_of(state));
  h5::set_text(file, "role", identity.role);
  h5::set_text(file, "program", identity.program);
  h5::set_text(file, "version", telekerf::kVersion);
  h5::set_text(file, "cell", identity.cell);
  h5::set_count(file, "epoch", identity.epoch);
  h5::set_count(file, "virtual_time", identity.virtual_time ? 1 : 0);
  h5::set_text(file, "clock", identity.virtual_time ? "virtual" : "CLOCK_MONOTONIC");
  h5::set_text(file, "created_utc", identity.created_utc);
  h5::set_text(file, "utc_at_zero_ns", fmt::format("{}", identity.utc_at_zero_ns));
  h5::set_text(file, "drive", identity.drive.name);
  h5::set_text(file, "drive_tool", identity.drive.true_tool ? "true" : "measured");
  h5::set_text(file, "settings", identity.settings);
  h5::set_text(file, "network", identity.network);
  const h5::Id words = h5::make_group(file, "words");
  for (const auto& [name, word] : identity.words) h5::set_text(words.get(), name.c_str(), word);
  const h5::Id figures = h5::make_group(file, "figures");
  for (const auto& [name, figure] : identity.figures) h5::set_number(figures.get(), name.c_str(), figure);
}

RunIdentity read_identity(hid_t file) {
  RunIdentity identity;
  const auto text = [&](const char* name) { return h5::text_of(file, name).value_or(""); };
  identity.role = text("role");
  identity.program = text("program");
  identity.cell = text("cell");
  identity.epoch = static_cast<std::uint32_t>(h5::number_of(file, "epoch").value_or(0));
  identity.virtual_time = h5::number_of(file, "virtual_time").value_or(0) != 0;
  identity.created_utc = text("created_utc");
  identity.utc_at_zero_ns = std::strtoll(text("utc_at_zero_ns").c_str(), nullptr, 10);
  identity.drive = {text("drive"), text("drive_tool") != "measured"};
  identity.settings = text("settings");
  identity.network = text("network");
  const h5::Id words(H5Gopen2(file, "words", H5P_DEFAULT), "it has no words");
  for (const std::string& name : h5::attributes_of(words.get()))
    identity.words[name] = h5::text_of(words.get(), name.c_str()).value_or("");
  const h5::Id figures(H5Gopen2(file, "figures", H5P_DEFAULT), "it has no figures");
  for (const std::string& name : h5::attributes_of(figures.get())) {
    if (const auto figure = h5::number_of(figures.get(), name.c_str())) identity.figures[name] = *figure;
  }
  return identity;
}

void write_schema(hid_t group, const SeriesSchema& schema) {
  std::vector<std::string> names, units, frames, sentences, kinds;
  for (const SeriesColumn& column : schema.columns) {
    names.push_back(column.name);
    units.push_back(column.unit);
    frames.push_back(column.frame);
    sentences.push_back(column.sentence);
    kinds.emplace_back(kKinds[static_cast<std::size_t>(column.kind)]);
  }
  h5::set_texts(group, "columns", names);
  h5::set_texts(group, "units", units);
  h5::set_texts(group, "frames", frames);
  h5::set_texts(group, "meanings", sentences);
  h5::set_texts(group, "kinds", kinds);
  h5::set_count(group, "every_tick", schema.every_tick ? 1 : 0);
}

SeriesSchema read_schema(hid_t group, const std::string& name) {
  SeriesSchema schema{name, {}, h5::number_of(group, "every_tick").value_or(0) != 0};
  const auto names = h5::texts_of(group, "columns");
  const auto units = h5::texts_of(group, "units");
  const auto frames = h5::texts_of(group, "frames");
  const auto sentences = h5::texts_of(group, "meanings");
  const auto kinds = h5::texts_of(group, "kinds");
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto at = [n](const std::vector<std::string>& texts) { return n < texts.size() ? texts[n] : ""; };
    const auto kind = std::find(std::begin(kKinds), std::end(kKinds), at(kinds));
    schema.columns.push_back({names[n], at(units), at(frames), at(sentences),
                              kind == std::end(kKinds) ? ColumnKind::kNumber
                                                       : static_cast<ColumnKind>(kind - std::begin(kKinds))});
  }
  return schema;
}

}  // namespace run_file
}  // namespace telekerf
