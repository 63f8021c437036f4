// SPDX-License-Identifier: Apache-2.0
// Starts the real programs for tests; whatever happens, none of them outlives the test.
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace telekerf::integration {

/// One running program with its output in a file.
class Program {
 public:
  /// `name`: one of ours, or an absolute path.
  Program(const std::string& name, const std::vector<std::string>& arguments);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void interrupt(int signal = SIGINT);
  void kill();
  bool running();
  /// Exit code, or -1 if it does not end in time.
  int wait(std::chrono::seconds timeout);
  std::string output() const;
  bool says(const std::string& text, std::chrono::seconds timeout) const;

  /// Gone with the test's process.
  static std::filesystem::path scratch();

 private:
  struct Child;
  std::filesystem::path output_;
  std::unique_ptr<Child> child_;
};

/// Whether every process of a cell is started with keys of it, made as they are needed (TELEKERF_TEST_SECURITY is set).
bool everyone_has_keys();

/// A DDS domain of this test process' own, away from the default one.
std::string own_domain();

}  // namespace telekerf::integration
