// SPDX-License-Identifier: Apache-2.0
#include "common/recording/draft.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>
#include <vector>

#include "common/recording/h5.h"

namespace telekerf {

namespace fs = std::filesystem;

namespace {

constexpr const char* kEnd = ".part";

/// Of "slave.h5.4711.part": "slave.h5" and "4711". Empty: the name is none of a draft.
std::pair<std::string, std::string> parts_of(std::string name) {
  if (!name.ends_with(kEnd)) return {};
  name.resize(name.size() - std::string(kEnd).size());
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return {};
  const std::string process = name.substr(dot + 1);
  const bool number = !process.empty() && std::all_of(process.begin(), process.end(),
                                                      [](unsigned char c) { return std::isdigit(c) != 0; });
  return number ? std::pair(name.substr(0, dot), process) : std::pair<std::string, std::string>();
}

}  // namespace

fs::path draft_of(const fs::path& file) { return file.string() + fmt::format(".{}{}", ::getpid(), kEnd); }

void put_in_place(const fs::path& draft, const fs::path& file) {
  const int fd = ::open(draft.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd >= 0) {
    ::fsync(fd);
    ::close(fd);
  }
  std::error_code failed;
  fs::rename(draft, file, failed);
  if (failed) throw h5::Failure("the finished file cannot be put in place: " + failed.message());
}

void remove_drafts(const fs::path& recording) {
  std::error_code error;
  const fs::path folder = recording.has_parent_path() ? recording.parent_path() : fs::path(".");
  const std::string own = recording.filename().string();
  const std::string flight = fmt::format("flight-{}-", recording.stem().string());
  std::vector<fs::path> left;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const auto [file, process] = parts_of(at->path().filename().string());
    if (file != own && !(file.starts_with(flight) && file.ends_with(".h5"))) continue;
    if (!fs::exists("/proc/" + process, error)) left.push_back(at->path());
  }
  for (const fs::path& draft : left) fs::remove(draft, error);
}

}  // namespace telekerf
