// SPDX-License-Identifier: Apache-2.0
// What a running process says on standard output: its states, how far it is, and single sentences.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace telekerf {

/// A control loop does not write: it leaves its state here, and a thread of the reporter's own says what has
/// changed. Several processes may share a terminal: a bar of one is wiped by whatever another says.
class StatusReporter {
 public:
  /// `who` begins every line: "slave: ...". `initial`: a state that need not be said.
  explicit StatusReporter(std::string who, const char* initial = nullptr);
  /// Says what has not been said yet.
  ~StatusReporter();
  StatusReporter(const StatusReporter&) = delete;
  StatusReporter& operator=(const StatusReporter&) = delete;

  /// A line, at once. Waits for the terminal: not from a control loop.
  void say(const std::string& sentence);

  /// Hears what is said, after it has been, in the thread that says it; none: nobody does any more.
  void listen(std::function<void(const std::string&)> listener);

  /// Wait-free. Said when it is another one than before; must be a literal.
  void state(const char* sentence) noexcept { state_.store(sentence, std::memory_order_relaxed); }
  /// Wait-free. How much of a work of `total_s` is done, 0 to 1: a bar on a terminal, elsewhere a line at
  /// each tenth.
  void progress(double fraction, double total_s) noexcept {
    total_s_.store(total_s, std::memory_order_relaxed);
    fraction_.store(fraction, std::memory_order_relaxed);
  }

 private:
  void run(const std::stop_token& stop);
  void report();

  std::string who_;
  bool terminal_;
  std::mutex writing_;
  std::mutex listening_;
  std::function<void(const std::string&)> listener_;
  std::atomic<const char*> state_;
  std::atomic<double> fraction_{0.0};
  std::atomic<double> total_s_{0.0};
  const char* said_;  ///< the thread's
  int tenth_ = 0;
  bool bar_ = false;
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
