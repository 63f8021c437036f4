// SPDX-License-Identifier: Apache-2.0
// The beam of a station, whatever laser makes it: chosen by its name, limited, and off at every doubt.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "slave/laser/laser.h"
#include "slave/laser/permit.h"

namespace telekerf {
class Settings;
}

namespace telekerf::laser {

struct LaserOutputSettings {
  LaserOutputSettings() = default;  // no aggregate, see RobotSupervisorSettings
  std::string laser = "simulated";  ///< a row of the registry in laser_output.cpp
  /// More is never asked for. 0: not stated; then kUnstated_w of a simulated laser, and no other is opened.
  double laser_max_w = 0.0;
  static constexpr double kUnstated_w = 1000.0;
  double max_w() const noexcept { return laser_max_w > 0.0 ? laser_max_w : kUnstated_w; }
  /// Nobody can be hurt by it.
  bool simulated() const;
  void add_parameters(Settings& settings);
  /// Throws StartupError if this laser is not to give `laser_w`.
  void validate(double laser_w) const;
};

/// What is wrong with a `laser` as a user wrote it, and the remedy; empty: nothing.
std::string validate_laser(const std::string& laser);

class LaserOutput {
 public:
  /// Off. `laser_w`: what it will be asked for as a rule. `laser`: another one than the settings name. Throws
  /// StartupError.
  LaserOutput(const LaserOutputSettings& settings, double laser_w, double control_hz,
              std::unique_ptr<Laser> laser = {});
  ~LaserOutput() { off(); }
  LaserOutput(const LaserOutput&) = delete;
  LaserOutput& operator=(const LaserOutput&) = delete;

  /// Every control step. Returns the power that the laser is given: at most what was permitted, clipped to
  /// `laser_max_w`, and none if it is negative or not finite, or if the permit does not cover `now_ns` or one
  /// as new was used before. The pilot beam needs none.
  double emit(Permit permit, std::int64_t now_ns, double power_w, bool pilot) noexcept;
  /// Beam and pilot: without a judgement, and after the last step.
  void off() noexcept { (void)tell({}); }

  /// Steps in which more than `laser_max_w` was asked for.
  std::uint64_t clipped() const noexcept { return clipped_; }
  /// Steps in which power was asked for without a permit.
  std::uint64_t unpermitted() const noexcept { return unpermitted_; }
  /// Steps in which the laser was not told, as far as is known.
  std::uint64_t write_failures() const noexcept { return write_failures_; }
  /// What came in the laser's place and was refused, see Laser::refused().
  std::uint64_t refused() const noexcept { return laser_->refused(); }

  /// The laser gives light only where it was told to, as far as it measures it; for good once it has not in
  /// two steps in a row.
  bool emission_agrees() const noexcept { return stray_steps_ < kStraySteps; }
  /// Not told time and again, or light that nobody asked for, from then on and for good: `failure()` says so
  /// in a sentence for the user. The laser is told to be off from then on, in case it hears.
  bool failed() const noexcept { return failed_; }
  std::string failure() const;

 private:
  double tell(const Emission& emission) noexcept;

  std::string name_;
  double max_w_;
  std::int64_t lasts_ns_;  ///< an emission without a permit, as the pilot's is
  double forgotten_a_step_;
  std::unique_ptr<Laser> laser_;
  static constexpr int kStraySteps = 2;
  int stray_steps_ = 0;          ///< in a row
  std::uint64_t used_tick_ = 0;  ///< of the newest permit that was used
  std::uint64_t clipped_ = 0;
  std::uint64_t unpermitted_ = 0;
  std::uint64_t write_failures_ = 0;
  double doubts_ = 0.0;  ///< steps write_failures, less what was forgotten of them since
  bool failed_ = false;
};

}  // namespace telekerf::laser
