// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/udp_laser_device.h"

#include <algorithm>
#include <cmath>

namespace telekerf::laser {
namespace {

/// A controller that has been silent this long has gone.
constexpr std::int64_t kGone_ns = 500'000'000;

}  // namespace

bool UdpLaserDevice::hear(const UdpPower& told, std::size_t size, const Sender& from,
                          std::int64_t now_ns) noexcept {
  if (size != sizeof(told) || told.magic != UdpPower::kMagic || told.version != UdpPower::kVersion ||
      !std::isfinite(told.power_w) || told.power_w < 0.0) {
    return false;
  }
  const bool off = told.power_w == 0.0 && told.pilot == 0;
  if (off && (newest_.sequence == 0 || now_ns - heard_ns_ >= kGone_ns)) {
    sender_ = from;
    newest_.sequence = 0;
    enable_ = 0;
  }
  if (from != sender_ || told.sequence <= newest_.sequence) return false;
  if (told.power_w > 0.0) {
    if (told.enable <= enable_) return false;
    enable_ = told.enable;
  }
  newest_ = told;
  heard_ns_ = now_ns;
  return true;
}

std::int64_t UdpLaserDevice::dark_ns() const noexcept {
  return heard_ns_ + std::min<std::int64_t>(udp_silence_ns(newest_.period_ns), newest_.lasts_ns);
}

double UdpLaserDevice::modulated_w() const noexcept {
  if (stuck_w_) return newest_.enable != 0 ? *stuck_w_ : 0.0;
  return std::min(newest_.power_w, max_w_);
}

UdpEmission UdpLaserDevice::answer(std::int64_t now_ns) const noexcept {
  UdpEmission answer;
  answer.sequence = newest_.sequence;
  answer.emission_w = power_w(now_ns);
  return answer;
}

}  // namespace telekerf::laser
