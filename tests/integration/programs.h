// SPDX-License-Identifier: Apache-2.0
// Starts the real programs for tests; whatever happens, none of them outlives the test.
#pragma once

#include <boost/filesystem.hpp>
#include <boost/process.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace telekerf::integration {

namespace bp = boost::process;

/// One running program with its output in a file.
class Program {
 public:
  Program(const std::string& name, const std::vector<std::string>& arguments)
      : output_(scratch() / (name + "-" + std::to_string(counter()++) + ".txt")),
        child_(TELEKERF_BIN_DIR "/" + name, bp::args(arguments),
               bp::std_in<bp::null, (bp::std_out & bp::std_err)> boost::filesystem::path(output_.string())) {}
  ~Program() {
    if (child_.running()) child_.terminate();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void interrupt(int signal = SIGINT) { ::kill(child_.id(), signal); }
  void kill() { child_.terminate(); }
  bool running() { return child_.running(); }
  /// Exit code, or -1 if it does not end in time.
  int wait(std::chrono::seconds timeout) {
    if (!child_.wait_for(timeout)) return -1;
    return child_.exit_code();
  }
  std::string output() const {
    std::ifstream in(output_);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  bool says(const std::string& text, std::chrono::seconds timeout) const {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (output().find(text) == std::string::npos) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }

  static std::filesystem::path scratch() {
    /// Gone with the test's process.
    struct Folder {
      std::filesystem::path path =
          std::filesystem::temp_directory_path() / ("telekerf-" + std::to_string(::getpid()));
      Folder() { std::filesystem::create_directories(path); }
      ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
      }
    };
    static const Folder folder;
    return folder.path;
  }

 private:
  static int& counter() {
    static int count = 0;
    return count;
  }
  std::filesystem::path output_;
  bp::child child_;
};

/// A DDS domain of this test process' own, away from the default one.
inline std::string own_domain() { return std::to_string(100 + ::getpid() % 100); }

}  // namespace telekerf::integration
