// SPDX-License-Identifier: Apache-2.0
// The recorded runs that the page may list, play and fetch. telekerf-inspect reads them, in a process of its own: a
// damaged file neither hangs nor ends the console, and nobody who drives waits for a disk.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace telekerf::master {

struct RunShelfSettings {
  std::filesystem::path folder = "out";  ///< whose folders are the runs
  std::filesystem::path inspect;         ///< telekerf-inspect
  std::chrono::milliseconds patience{20'000};
};

/// What a page asks for: the list, or one thing of one run ("playback", "master.csv").
struct RunQuestion {
  std::string name;  ///< empty: the list
  std::string what;
};
/// Of "/runs" and "/run?name=NAME&what=WHAT"; false: something else is asked for. What can be no folder within the
/// shelf, or nothing of a run, is left empty.
bool parse_run_question(std::string_view target, RunQuestion& question);

class RunShelf {
 public:
  struct Answer {
    int status = 200;   ///< of HTTP: 404 what there is not, 503 busy, 504 not in time
    std::string bytes;  ///< otherwise a sentence
  };
  using Done = std::function<void(Answer)>;

  RunShelf(boost::asio::io_context& context, RunShelfSettings settings);
  /// Ends what is being read.
  ~RunShelf();
  RunShelf(const RunShelf&) = delete;
  RunShelf& operator=(const RunShelf&) = delete;

  /// `done` is called once, from the context's thread, unless the shelf is gone before. One question at a time.
  void ask(const RunQuestion& question, Done done);

 private:
  struct Reading;
  boost::asio::io_context& context_;
  RunShelfSettings settings_;
  std::weak_ptr<Reading> reading_;
};

}  // namespace telekerf::master
