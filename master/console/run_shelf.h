// SPDX-License-Identifier: Apache-2.0
// The recorded runs that the page may list, play and fetch. telekerf-inspect reads them, in a process of its own: a
// damaged file neither hangs nor ends the console, and nobody who drives waits for a disk.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/run_record.h"

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

  /// So many questions are answered at the same time,
  static constexpr std::size_t kAtOnce = 3;
  /// and so many more wait; who asks then is refused.
  static constexpr std::size_t kMostWaiting = 12;

  /// `done` is called once, from the context's thread, unless the shelf is gone before.
  void ask(const RunQuestion& question, Done done);
  /// What was read and what was not, as figures `runs_...`.
  void add_figures(Metrics& figures) const;

 private:
  struct Reading;
  struct Waiting {
    std::vector<std::string> words;  ///< of telekerf-inspect's command line
    Done done;
  };
  void refuse(int status, const std::string& why, const Done& done);
  void read(Waiting question);
  void ended(const Reading* reading);

  boost::asio::io_context& context_;
  RunShelfSettings settings_;
  std::vector<std::shared_ptr<Reading>> readings_;
  std::deque<Waiting> waiting_;
  std::shared_ptr<std::size_t> held_ = std::make_shared<std::size_t>(0);  ///< bytes of all readings
  std::uint64_t read_ = 0, failed_ = 0, refused_ = 0;
};

}  // namespace telekerf::master
