// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;

void refuse_unwritable(const std::string& option, const fs::path& folder) {
  if (folder.empty()) throw usage_error(fmt::format("{} is empty: name a folder for the results", option));
  std::error_code ignored;
  fs::path there = fs::absolute(folder);
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  const auto refuse = [&](const char* complaint) {
    throw environment_error(
        fmt::format("{} {}: {} {}; name another folder", option, folder.string(), there.string(), complaint));
  };
  if (!fs::is_directory(there, ignored)) refuse("is no folder");
  if (::access(there.c_str(), W_OK) != 0) refuse("cannot be written to");
}

void make_folder(const std::string& option, const fs::path& folder) {
  refuse_unwritable(option, folder);
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw environment_error(
        fmt::format("{} {}: {}; name another folder", option, folder.string(), failed.message()));
}

OutputPlace output_place(const fs::path& file) {
  std::error_code failed;
  const fs::path place = fs::is_symlink(file, failed) ? fs::weakly_canonical(file, failed) : file;
  const bool other = fs::exists(place, failed) && !fs::is_regular_file(place, failed) && !fs::is_directory(place, failed);
  return {other ? place : fs::path(place.string() + fmt::format(".{}.part", ::getpid())), place};
}

void write_atomically(const fs::path& file, const std::string& text) {
  std::error_code failed;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), failed);
  const auto [draft, place] = output_place(file);
  {
    errno = 0;
    std::ofstream out(draft, std::ios::binary);
    out << text;
    out.close();
    if (!out) {
      const std::string why = errno == 0 ? "cannot be written" : std::system_category().message(errno);
      if (draft != place) fs::remove(draft, failed);
      throw environment_error(fmt::format("{}: {}; name a folder that is writable and has {} kB free",
                                          file.string(), why, text.size() / 1000 + 1));
    }
  }
  if (draft == place) return;
  fs::rename(draft, place, failed);
  if (!failed) return;
  std::error_code ignored;
  fs::remove(draft, ignored);
  throw environment_error(fmt::format("{}: {}", file.string(), failed.message()));
}

}  // namespace telekerf
