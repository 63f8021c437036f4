// SPDX-License-Identifier: Apache-2.0
// A small piece of work for the station of automatic machining, and what it was refused for.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/runtime/startup_error.h"
#include "slave/machining/station.h"

namespace telekerf::machining {

namespace fs = std::filesystem;

template <class Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

inline ContourMessage square(double side_m) {
  const double h = side_m / 2;
  ContourMessage message;
  message.id = 1;
  message.closed = true;
  message.points_m = {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
  return message;
}

inline StationSettings quick() {
  StationSettings settings;
  settings.no_framing = true;
  settings.speed_mm_s = 20.0;
  return settings;
}

class MachiningAtWork : public testing::Test {
 protected:
  explicit MachiningAtWork(const StationSettings& settings = quick()) : station_(settings) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    job_ = station_.prepare(square(1.5e-3));
  }
  ~MachiningAtWork() override { fs::remove_all(folder_); }
  MachiningAtWork(const MachiningAtWork&) = delete;
  MachiningAtWork& operator=(const MachiningAtWork&) = delete;

  /// Steps until it has ended; `stop_at` lit steps: from then on the stop is pressed.
  void work(int stop_at = -1) {
    station_.begin(*job_);
    while (!station_.ended()) {
      ASSERT_LT(steps_, 100'000);
      const bool stop = stop_at >= 0 && lit_ >= stop_at;
      const JobExecutorOutputs out = station_.step(now_ns(), stop);
      ++steps_;
      held_ += stop ? 1 : 0;
      if (stop) {
        ASSERT_EQ(out.laser_w, 0.0);
      }
      if (out.laser_w <= 0.0) continue;
      ++lit_;
      energy_j_ += out.laser_w * job_->period_s;
    }
  }

  /// Of the next step.
  std::int64_t now_ns() { return now_ns_ += 416'667; }
  std::int64_t now_ns_ = 0;

  fs::path folder_ =
      fs::path(testing::TempDir()) / ("telekerf_machining_station-" + std::to_string(::getpid()));
  Station station_;
  std::unique_ptr<Job> job_;
  int steps_ = 0;
  int lit_ = 0;
  int held_ = 0;
  double energy_j_ = 0.0;
};

}  // namespace telekerf::machining
