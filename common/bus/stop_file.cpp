// SPDX-License-Identifier: Apache-2.0
#include "common/bus/stop_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

namespace fs = std::filesystem;

std::string why() { return std::strerror(errno); }

/// Nothing where there is nothing.
void settle_one(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return;
  (void)::fsync(fd);
  ::close(fd);
}

}  // namespace

StopFile::StopFile(std::string path) : path_(std::move(path)) {
  if (path_.empty()) return;
  std::error_code error;
  fs::create_directories(fs::path(path_).parent_path(), error);  // writing tells
  const bool there = fs::exists(path_, error);
  if (there && !fs::is_regular_file(path_, error))
    throw environment_error(fmt::format("--stop-file {}: it is no file; name another one", path_));
  if (!there) {
    const std::string obstacle = write("");
    if (!obstacle.empty())
      throw environment_error(
          fmt::format("--stop-file {}: an emergency stop could not be kept over a restart: {}; name another "
                      "file, or say --stop-file off",
                      path_, obstacle));
    fs::remove(path_ + ".new", error);
    return;
  }
  std::ifstream file(path_);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  found_ = StopLatch::from_text(text);
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  if (!file || found_.in_force().empty() || found_.in_force().size() != lines || text.back() != '\n')
    throw environment_error(fmt::format(
        "--stop-file {}: what stands in it is no emergency stop, so nobody knows whether one is in "
        "force; look at the machine, then remove the file",
        path_));
}

std::string StopFile::write(const std::string& text) const {
  const int fd = ::open((path_ + ".new").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return why();
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const std::string obstacle = written ? std::string() : why();
  ::close(fd);
  return obstacle;
}

std::string StopFile::keep(const std::string& text) const {
  if (path_.empty()) return {};
  if (text.empty()) {
    if (::unlink(path_.c_str()) != 0 && errno != ENOENT) return why();
  } else {
    std::error_code ignored;
    fs::create_directories(fs::path(path_).parent_path(), ignored);  // somebody may have removed it
    if (const std::string obstacle = write(text); !obstacle.empty()) return obstacle;
    if (::rename((path_ + ".new").c_str(), path_.c_str()) != 0) return why();
  }
  return {};
}

void StopFile::settle() const {
  if (path_.empty()) return;
  settle_one(path_);
  settle_one(fs::path(path_).parent_path());
}

}  // namespace telekerf
