// SPDX-License-Identifier: Apache-2.0
#include "tests/system/programs.h"

#include <unistd.h>

#include <boost/filesystem.hpp>
#include <algorithm>
#include <boost/process.hpp>
#include <cstdlib>
#include <sstream>

namespace telekerf::integration {
namespace {

namespace bp = boost::process;

std::string next_output(const std::string& name) {
  static int count = 0;
  return std::filesystem::path(name).filename().string() + "-" + std::to_string(count++) + ".txt";
}

std::string word_after(const std::vector<std::string>& words, const std::string& flag) {
  const auto at = std::find(words.begin(), words.end(), flag);
  return at == words.end() || at + 1 == words.end() ? "" : *(at + 1);
}

bool has(const std::vector<std::string>& words, const std::string& flag) {
  return std::find(words.begin(), words.end(), flag) != words.end();
}

std::vector<std::string> with_keys(std::vector<std::string> words) {
  const bool of_a_cell = has(words, "--domain") || has(words, "--cell");
  const bool given = has(words, "--security") || has(words, "--insecure");
  if (!everyone_has_keys() || !of_a_cell || given) return words;
  const std::string named = word_after(words, "--cell");
  const std::string cell = named.empty() ? "cell-1" : named;
  const std::filesystem::path store = Program::scratch() / "keys";
  if (!std::filesystem::exists(store / "cells" / cell)) {
    const std::string renew = std::filesystem::exists(store) ? " --renew" : "";
    const std::string make = std::string(TELEKERF_BIN_DIR) + "/telekerf-keys " + store.string() + " --cells " + cell;
    if (std::system((make + renew + " > /dev/null").c_str()) != 0) return words;
  }
  words.insert(words.end(), {"--security", store.string()});
  return words;
}

}  // namespace

bool everyone_has_keys() { return std::getenv("TELEKERF_TEST_SECURITY") != nullptr; }

struct Program::Child : bp::child {
  using bp::child::child;
};

Program::Program(const std::string& name, const std::vector<std::string>& arguments)
    : output_(scratch() / next_output(name)),
      child_(std::make_unique<Child>(
          (std::filesystem::path(TELEKERF_BIN_DIR) / name).string(), bp::args(with_keys(arguments)), bp::limit_handles,
          bp::std_in<bp::null, (bp::std_out & bp::std_err)> boost::filesystem::path(output_.string()))) {}

Program::~Program() {
  if (running()) kill();
}

void Program::interrupt(int signal) { ::kill(child_->id(), signal); }

void Program::kill() { child_->terminate(); }

bool Program::running() { return child_->running(); }

int Program::wait(std::chrono::seconds timeout) {
  // Boost's own wait sleeps to its end where another child has ended before.
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (child_->running()) {
    if (std::chrono::steady_clock::now() > end) return -1;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return child_->exit_code();
}

std::string Program::output() const {
  std::ifstream in(output_);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

bool Program::says(const std::string& text, std::chrono::seconds timeout) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (output().find(text) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

std::filesystem::path Program::scratch() {
  struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("telekerf-" + std::to_string(::getpid()));
    Folder() {
      std::filesystem::create_directories(path);
      // Stops that a test leaves in force are nobody else's.
      ::setenv("XDG_STATE_HOME", (path / "state").c_str(), 1);  // NOLINT
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

std::string own_domain() { return std::to_string(1 + ::getpid() % 100); }

}  // namespace telekerf::integration
