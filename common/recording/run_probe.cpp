// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_probe.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "common/recording/run_folder.h"
#include "common/recording/run_reader.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace fs = std::filesystem;

std::chrono::seconds patience_with(const fs::path& file) {
  std::error_code failed;
  const auto bytes = fs::file_size(file, failed);
  return std::chrono::seconds(20 + (failed ? 0 : bytes >> 21U));
}

int in_child(const fs::path& file, const std::function<int()>& work, std::chrono::seconds limit) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child < 0)
    throw environment_error(fmt::format("{}: no process can be started to read it", file.string()));
  if (child == 0) {
    const int code = work();
    std::fflush(stdout);
    ::_exit(code);
  }
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + limit;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      throw input_error(fmt::format(
          "{}: is damaged so that reading it does not end; it is as it was: use another copy of it",
          file.string()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (!WIFEXITED(status))
    throw input_error(fmt::format(
        "{}: is damaged so that reading it fails (signal {}); it is as it was: use another copy of it",
        file.string(), WTERMSIG(status)));
  return WEXITSTATUS(status);
}

std::string told_by_child(const fs::path& file, const std::function<std::string()>& work,
                          std::chrono::seconds limit) {
  std::array<int, 2> words{};
  if (::pipe(words.data()) != 0)
    throw environment_error(fmt::format("{}: no pipe to read it by", file.string()));
  const auto said = [&] {
    ::close(words[1]);
    std::string text(kMostTold, '\0');
    const ssize_t length = ::read(words[0], text.data(), text.size());
    ::close(words[0]);
    text.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return text;
  };
  const auto tell = [&](const std::string& text) {
    return ::write(words[1], text.data(), std::min(text.size(), kMostTold)) >= 0;
  };
  constexpr int kTold = 0, kThrew = 2, kMute = 3;
  int code = kTold;
  try {
    const auto child = [&] {
      try {
        return tell(work()) ? kTold : kMute;
      } catch (const std::exception& error) {
        return tell(error.what()) ? kThrew : kMute;
      }
    };
    code = in_child(file, child, limit);
  } catch (...) {
    (void)said();
    throw;
  }
  std::string text = said();
  if (code == kTold) return text;
  throw input_error(text.empty() ? fmt::format("{}: is damaged so that reading it fails", file.string())
                                 : text);
}

void probe_recording(const fs::path& file) {
  const auto read = [&]() -> std::string {
    const RunReader reader(file);
    if (reader.state() != RunState::kRecording) return {};  // its checksum was made of all that is in it
    for (const auto& series : reader.series()) (void)reader.data(series.schema.name);
    (void)reader.events();
    (void)reader.contours();
    return {};
  };
  (void)told_by_child(file, read, patience_with(file));
}

void probe_recordings(std::span<const fs::path> folders) {
  for (const fs::path& folder : folders) {
    for (const char* role : kRecordedRoles) {
      const fs::path file = folder / fmt::format("{}.h5", role);
      std::error_code ignored;
      if (fs::exists(file, ignored)) probe_recording(file);
    }
  }
}

}  // namespace telekerf
