// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <mutex>
#include <string_view>

#include "common/recording/draft.h"
#include "common/recording/run_reader.h"
#include "common/recording/run_tables.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;
namespace {

/// The contours that were in force, in order, as the master's file tells them.
void read_contours(const RunReader& master, RunRecord& record) {
  const std::vector<RunContour> contours = master.contours();
  const auto data = master.data("in_force");
  const auto began = data ? rows_of(*data, in_force_columns()) : std::vector<InForceRow>();
  const auto find = [&](std::uint32_t id) {
    return std::find_if(contours.begin(), contours.end(), [&](const RunContour& c) { return c.id == id; });
  };
  for (std::size_t n = 0; n < began.size(); ++n) {
    const auto found = find(began[n].contour_id);
    if (found == contours.end()) continue;
    if (n + 1 < began.size()) {
      record.earlier.push_back({began[n + 1].tick, found->closed, found->points_m});
    } else {
      record.contour_m = found->points_m;
      record.contour_closed = found->closed;
      record.words["image"] = found->source;
      record.words["mode"] = found->mode;
    }
  }
}

template <typename Row>
std::vector<Row> rows_in(const RunReader& reader, std::span<const Column<Row>> columns) {
  const auto data = reader.data(reader.identity().role);
  return data ? rows_of(*data, columns) : std::vector<Row>();
}

void take_master(const RunReader& reader, RunRecord& record) {
  record.words = reader.identity().words;
  record.master_figures = reader.identity().figures;
  record.master_drive = reader.identity().drive;
  record.master = rows_in(reader, master_columns());
  read_contours(reader, record);
}

void take_slave(const RunReader& reader, RunRecord& record) {
  record.slave_figures = reader.identity().figures;
  record.slave_drive = reader.identity().drive;
  record.slave = rows_in(reader, slave_columns());
}

fs::path folder_with(const std::string& file, std::span<const fs::path> folders) {
  for (const fs::path& folder : folders)
    if (fs::exists(folder / file)) return folder;
  std::string all;
  for (const fs::path& folder : folders) all += (all.empty() ? "" : ", ") + folder.string();
  const std::string role = file.substr(0, file.find('.'));
  throw input_error(fmt::format(
      "{}: holds no {}.h5, the recording of telekerf-{}; is this the folder of a run, or must the "
      "other site's be named as well?",
      all, role, role));
}

}  // namespace

std::optional<RunKept> recover_run_file(const fs::path& file) {
  {
    const RunReader reader(file, RunReader::Check::kHead);
    if (reader.state() != RunState::kRecording) {
      remove_drafts(file);
      return std::nullopt;
    }
    if (const auto writer = reader.writer())
      throw environment_error(fmt::format("{}: process {} still records into it; end it first (kill -INT {})",
                                          file.string(), *writer, *writer));
  }
  try {
    const RunKept kept = finish_run_file(file, {.state = RunState::kRecovered});
    remove_drafts(file);
    return kept;
  } catch (const h5::Failure& failure) {
    throw environment_error(fmt::format("{}: cannot be recovered: {}", file.string(), failure.what()));
  }
}

std::optional<fs::path> find_recording(const std::string& role, std::span<const fs::path> folders) {
  for (const fs::path& folder : folders)
    if (fs::exists(folder / (role + ".h5"))) return folder / (role + ".h5");
  return std::nullopt;
}

std::optional<fs::path> recording_of(const std::string& role, std::span<const fs::path> folders) {
  const auto file = find_recording(role, folders);
  if (!file) return std::nullopt;
  if (const std::string of = RunReader(*file, RunReader::Check::kHead).identity().role; of != role)
    throw input_error(
        fmt::format("{}: is the recording of telekerf-{}; name it {}.h5 again", file->string(), of, of));
  (void)recover_run_file(*file);
  return file;
}

void refuse_idle_folders(std::span<const fs::path> folders) {
  std::map<std::string, fs::path> from;  // by role, where it is taken from
  for (const fs::path& folder : folders) {
    bool adds = false;
    std::string there_already;
    for (const char* role : kRecordedRoles) {
      if (!fs::exists(folder / fmt::format("{}.h5", role)) && !fs::exists(folder / fmt::format("{}.csv", role))) continue;
      const auto [found, is_new] = from.try_emplace(role, folder);
      adds = adds || is_new;
      if (!is_new) there_already += fmt::format("{}{}", there_already.empty() ? "" : ", ", role);
    }
    if (adds || &folder == &folders.front()) continue;
    throw input_error(
        there_already.empty()
            ? fmt::format("{}: holds no recording of a run; name the other site's folder, or leave it out", folder.string())
            : fmt::format("{}: nothing of it is needed: {} has the recordings of {} already; leave one of them out",
                          folder.string(), folders.front().string(), there_already));
  }
}

void refuse_to_replace_recording(const std::string& option, const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return;
  char head[8] = {};
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  if (std::string_view(head, sizeof head) == std::string_view("\x89HDF\r\n\x1a\n", 8))
    throw usage_error(fmt::format("{} {}: is the recording of a run, or other HDF5; name another file", option, file.string()));
}

RunRecord read_run(std::span<const fs::path> folders) {
  RunRecord record;
  if (const auto file = recording_of("master", folders)) {
    take_master(RunReader(*file, RunReader::Check::kHead), record);
  } else {
    read_master(folder_with("master.csv", folders), record);
  }
  if (const auto file = recording_of("slave", folders)) {
    take_slave(RunReader(*file, RunReader::Check::kHead), record);
  } else {
    read_slave(folder_with("slave.csv", folders), record);
  }
  return record;
}

fs::path place_of_run(const fs::path& folder) {
  std::error_code error;
  const auto has_some = [&error](const fs::path& place) {
    return std::any_of(std::begin(kRecordedRoles), std::end(kRecordedRoles), [&](const char* role) {
      return fs::exists(place / fmt::format("{}.h5", role), error);
    });
  };
  if (has_some(folder)) return folder;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().starts_with(".run-") && has_some(at->path())) return at->path();
  }
  return folder;
}

RunRecord read_run_so_far(const fs::path& folder) {
  RunRecord record;
  if (fs::exists(folder / "master.h5"))
    take_master(RunReader(folder / "master.h5", RunReader::Check::kHead), record);
  if (fs::exists(folder / "slave.h5"))
    take_slave(RunReader(folder / "slave.h5", RunReader::Check::kHead), record);
  return record;
}

namespace {

/// Into a copy that takes the file's place: whoever is killed meanwhile leaves the file as it was.
void label_file(const fs::path& file, const RunLabel& label) {
  const fs::path place = fs::canonical(file);  // a link stays one
  const fs::path draft = draft_of(place);
  try {
    fs::copy_file(place, draft, fs::copy_options::overwrite_existing);
    {
      const h5::Id open(H5Fopen(draft.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "it cannot be written to");
      for (const char* name : {"label", "label_text"})
        if (H5Aexists(open.get(), name) > 0)
          h5::check(H5Adelete(open.get(), name), "its label cannot be replaced");
      h5::set_text(open.get(), "label", label.good ? "good" : "bad");
      h5::set_text(open.get(), "label_text", label.text);
      h5::check(H5Fflush(open.get(), H5F_SCOPE_GLOBAL), "its label cannot be written out");
    }
    put_in_place(draft, place);
  } catch (...) {
    std::error_code ignored;
    fs::remove(draft, ignored);
    throw;
  }
}

}  // namespace

void label_run(const fs::path& folder, const RunLabel& label) {
  const std::lock_guard alone(h5::library());
  std::size_t files = 0;
  for (const char* role : kRecordedRoles) {
    const auto file = recording_of(role, std::span(&folder, 1));
    if (!file) continue;
    ++files;
    try {
      label_file(*file, label);
    } catch (const h5::Failure& failure) {
      throw environment_error(fmt::format("{}: {}", file->string(), failure.what()));
    } catch (const fs::filesystem_error& failure) {
      throw environment_error(
          fmt::format("{}: cannot be labelled: {}; is there room in its folder, and may you write there?",
                      file->string(), failure.code().message()));
    }
  }
  if (files == 0) throw input_error(fmt::format("{}: holds no recording of a run", folder.string()));
}

std::optional<RunLabel> label_of(const fs::path& file) {
  const std::lock_guard alone(h5::library());
  try {
    const h5::Id open = h5::open_file(file);
    const auto label = h5::text_of(open.get(), "label");
    if (!label) return std::nullopt;
    return RunLabel{*label == "good", h5::text_of(open.get(), "label_text").value_or("")};
  } catch (const h5::Failure&) {
    return std::nullopt;
  }
}

}  // namespace telekerf
