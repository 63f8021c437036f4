// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/status_reporter.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "common/runtime/say.h"

namespace telekerf {
namespace {

constexpr std::chrono::milliseconds kPeriod{50};
constexpr int kBarWidth = 40;
constexpr const char* kWipe = "\r\033[K";

}  // namespace

StatusReporter::StatusReporter(std::string who, const char* initial)
    : who_(std::move(who)),
      terminal_(isatty(STDOUT_FILENO) != 0),
      state_(initial),
      said_(initial),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

StatusReporter::~StatusReporter() {
  thread_.request_stop();
  thread_.join();
  report();
  if (bar_) write_text(stdout, kWipe);
}

void StatusReporter::say(const std::string& sentence) {
  {
    const std::lock_guard lock(writing_);
    write_line(stdout, fmt::format("{}{}: {}", terminal_ ? kWipe : "", who_, sentence));
  }
  const std::lock_guard lock(listening_);
  if (listener_) listener_(sentence);
}

void StatusReporter::listen(std::function<void(const std::string&)> listener) {
  const std::lock_guard lock(listening_);
  listener_ = std::move(listener);
}

void StatusReporter::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(kPeriod);
    report();
  }
}

void StatusReporter::report() {
  if (const char* const now = state_.load(); now != said_) {
    said_ = now;
    say(now);
  }
  const double fraction = std::clamp(fraction_.load(), 0.0, 1.0);
  const double total_s = total_s_.load();
  if (fraction <= 0.0) return;
  if (terminal_) {
    const int full = static_cast<int>(fraction * kBarWidth);
    const std::lock_guard lock(writing_);
    write_text(stdout, fmt::format("\r  [{:#<{}}{:.<{}}] {:4.1f} s of {:.0f} s", "", full, "",
                                   kBarWidth - full, fraction * total_s, total_s));
    bar_ = true;
  } else if (const int tenth = static_cast<int>(10.0 * fraction); tenth > tenth_ && tenth < 10) {
    tenth_ = tenth;
    say(fmt::format("{} %, {:.0f} s to go", 10 * tenth, (1.0 - fraction) * total_s));
  }
}

}  // namespace telekerf
