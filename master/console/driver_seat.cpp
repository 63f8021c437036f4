// SPDX-License-Identifier: Apache-2.0
#include "master/console/driver_seat.h"

#include <cmath>

namespace telekerf::master {

std::optional<std::uint32_t> DriverSeat::take(std::uint32_t page, std::int64_t now_ns) noexcept {
  step(now_ns);
  if (taken() && !drives(page)) return std::nullopt;
  page_ = page;
  armed_ = false;
  heard_ns_ = now_ns;
  gate_.begin();
  passed_ = {};
  ++lease_;
  return lease_;
}

void DriverSeat::leave(std::uint32_t page) noexcept {
  if (drives(page)) vacate();
}

void DriverSeat::vacate() noexcept {
  page_.reset();
  armed_ = false;
}

void DriverSeat::step(std::int64_t now_ns) noexcept {
  if (taken() && now_ns - heard_ns_ >= kAbsent_ns) vacate();
}

std::optional<UdpHandFrame> DriverSeat::hear(std::uint32_t page, const PageFrame& frame,
                                             std::int64_t now_ns) noexcept {
  step(now_ns);
  if (!drives(page) || frame.lease != lease_) return std::nullopt;
  const bool held = (frame.flags & (PageFrame::kHeld | PageFrame::kTrigger)) != 0;
  if (!gate_.hear({frame.sequence, static_cast<std::int64_t>(frame.page_ms * 1e6), held}, now_ns))
    return std::nullopt;
  heard_ns_ = now_ns;
  passed_[frame.sequence % passed_.size()] = {frame.sequence, frame.page_ms, now_ns};
  UdpHandFrame hand;
  hand.session = lease_;
  if ((frame.flags & PageFrame::kHeld) != 0) hand.flags |= UdpHandFrame::kHeld;
  if ((frame.flags & PageFrame::kTrigger) != 0 && armed_) hand.flags |= UdpHandFrame::kTrigger;
  hand.sequence = frame.sequence;
  hand.sent_ns = now_ns;
  hand.x_m = frame.x_m;
  hand.y_m = frame.y_m;
  return hand;
}

std::optional<DriverSeat::Passed> DriverSeat::passed(std::uint32_t lease,
                                                     std::uint64_t sequence) const noexcept {
  const Passed& place = passed_[sequence % passed_.size()];
  if (lease != lease_ || sequence == 0 || place.sequence != sequence) return std::nullopt;
  return place;
}

}  // namespace telekerf::master
