// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_probe.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

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

int in_child(const fs::path& file, const std::function<int()>& work) {
  std::error_code ignored;
  const auto bytes = fs::file_size(file, ignored);
  const auto limit = std::chrono::seconds(20 + (ignored ? 0 : bytes >> 21U));  // at 2 MB/s
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

void probe_recording(const fs::path& file) {
  std::array<int, 2> words{};
  if (::pipe(words.data()) != 0)
    throw environment_error(fmt::format("{}: no pipe to read it by", file.string()));
  const auto said = [&] {
    ::close(words[1]);
    std::string sentence(2048, '\0');
    const ssize_t length = ::read(words[0], sentence.data(), sentence.size());
    ::close(words[0]);
    sentence.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return sentence;
  };
  int code = 0;
  try {
    code = in_child(file, [&] {
      try {
        const RunReader reader(file);
        for (const auto& series : reader.series()) (void)reader.data(series.schema.name);
        (void)reader.events();
        (void)reader.contours();
        return 0;
      } catch (const std::exception& error) {
        const std::string sentence = std::string(error.what()).substr(0, 2048);
        return ::write(words[1], sentence.data(), sentence.size()) < 0 ? 3 : 2;
      }
    });
  } catch (...) {
    (void)said();
    throw;
  }
  const std::string sentence = said();
  if (code == 0) return;
  throw input_error(sentence.empty() ? fmt::format("{}: is damaged so that reading it fails", file.string())
                                     : sentence);
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
