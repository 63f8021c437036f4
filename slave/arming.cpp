// SPDX-License-Identifier: Apache-2.0
#include "slave/arming.h"

namespace telekerf::slave {
namespace {

/// By how many engagements `a` is after `b`, around the end of 32 bits.
std::int32_t after(std::uint32_t a, std::uint32_t b) noexcept { return static_cast<std::int32_t>(a - b); }
std::uint32_t later(std::uint32_t a, std::uint32_t b) noexcept { return after(a, b) > 0 ? a : b; }

}  // namespace

void Arming::step(const streaming::Played& played, const Circumstances& now) noexcept {
  // Another master counts anew, and what it began before it was heard is spent.
  if (now.heard && now.master_epoch != master_epoch_) {
    master_epoch_ = now.master_epoch;
    spent_ = leading_ = newest_led_ = now.newest_engage;
    spend(now.newest_engage);
  }
  // Also while nobody is heard: another sender may just have been tried in vain.
  const std::uint32_t newest = now.heard ? now.newest_engage : spent_;
  if (now.stopped) spend(newest);
  if (now.contour_id != contour_id_) {
    contour_id_ = now.contour_id;
    spend(newest);
  }
  const streaming::StreamSample* sample = played.sample;
  const bool good = sample != nullptr && played.age_s && *played.age_s <= settings_.follow_age_s;
  outage_s_ = good || !armed_ ? 0.0 : outage_s_ + dt_s_;
  if (outage_s_ > settings_.beam_age_s) spend(leading_);
  // A play-out that waits hides a silence, and a process that slept has made no steps. What comes first after
  // it was begun before anybody could know that it is over.
  if (now.silent_s > settings_.beam_age_s) spend(newest);
  if (!good) return;
  if (*played.age_s > settings_.beam_age_s) {
    button_armed_ = false;
  } else if (!sample->concealed && !sample->button) {
    button_armed_ = armed_;
  }
}

bool Arming::may_lead(std::uint32_t engage) noexcept {
  if (after(engage, spent_) <= 0) return false;
  if (!armed_ || engage != leading_) button_armed_ = false;
  leading_ = engage;
  newest_led_ = later(engage, newest_led_);
  armed_ = true;
  return true;
}

void Arming::spend(std::uint32_t engage) noexcept {
  spent_ = later(later(engage, spent_), newest_led_);
  armed_ = button_armed_ = false;
  outage_s_ = 0.0;
}

}  // namespace telekerf::slave
