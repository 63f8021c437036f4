// SPDX-License-Identifier: Apache-2.0
// No motion and no light comes back by itself: after a stop, an outage, another contour or a start the
// engagement from before is spent, and the button counts only once it was seen released.
#pragma once

#include <cstdint>
#include <optional>

#include "common/streaming/command_receiver.h"

namespace telekerf::slave {

struct FreshnessSettings {
  double beam_age_s = 0.35;   ///< commands older than this give no light; an outage longer than this ends an
                              ///< engagement
  double follow_age_s = 2.5;  ///< commands older than this are not followed
  bool operator==(const FreshnessSettings&) const = default;
};

/// Of one control step, beside what the stream has.
struct Circumstances {
  bool stopped = false;             ///< emergency stop
  bool heard = false;               ///< commands have come
  std::uint32_t master_epoch = 0;   ///< of whom they are
  std::uint32_t contour_id = 0;     ///< 0: none is known
  std::uint32_t newest_engage = 0;  ///< of the newest block that came
  double silent_s = 0.0;            ///< before this step nothing had come for so long
};

/// Engagements are counted by the master; each may lead until it is spent.
class Arming {
 public:
  Arming(const FreshnessSettings& settings, double dt_s) noexcept : settings_(settings), dt_s_(dt_s) {}

  /// Every control step, once, before may_lead().
  void step(const streaming::Played& played, const Circumstances& now) noexcept;
  /// True: the engagement of this number leads from now on. A new one counts the button only once released.
  bool may_lead(std::uint32_t engage) noexcept;

  /// An engagement leads that no stop, outage, contour or start has ended.
  bool armed() const noexcept { return armed_; }
  /// And the button was seen released since it began, and since commands were too old for the beam.
  bool button_armed() const noexcept { return armed_ && button_armed_; }
  /// Engagements up to this one are not followed any more.
  std::uint32_t spent() const noexcept { return spent_; }

  bool operator==(const Arming&) const = default;

 private:
  void spend(std::uint32_t engage) noexcept;

  FreshnessSettings settings_;
  double dt_s_;
  std::optional<std::uint32_t> master_epoch_;  ///< none: no master has been heard
  std::uint32_t contour_id_ = 0;
  std::uint32_t spent_ = 0;
  std::uint32_t leading_ = 0;     ///< at present, or last
  std::uint32_t newest_led_ = 0;  ///< of all that have led
  bool armed_ = false;
  bool button_armed_ = false;
  double outage_s_ = 0.0;  ///< since there was anything to follow, while armed
};

}  // namespace telekerf::slave
