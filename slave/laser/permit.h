// SPDX-License-Identifier: Apache-2.0
// The right to light at one control step. No power reaches a laser without one, and only the interlock makes
// it.
#pragma once

#include <cstdint>
#include <utility>

namespace telekerf::laser {

/// Good for one call of LaserOutput::emit(), and for two control periods from the judgement on: it is moved,
/// never copied, so that yesterday's cannot be kept. As made by anybody else it permits nothing.
class Permit {
 public:
  Permit() noexcept = default;
  Permit(Permit&& other) noexcept { take(other); }
  Permit& operator=(Permit&& other) noexcept {
    take(other);
    return *this;
  }
  Permit(const Permit&) = delete;
  Permit& operator=(const Permit&) = delete;
  ~Permit() = default;

  /// At this time, ns of the clock that the interlock was asked by.
  bool covers(std::int64_t now_ns) const noexcept { return made_ns_ <= now_ns && now_ns < end_ns_; }
  /// Of the judgement; from 1, one more each time. 0: permits nothing.
  std::uint64_t tick() const noexcept { return tick_; }
  /// From here on it permits nothing.
  std::int64_t end_ns() const noexcept { return end_ns_; }
  /// Power that was judged.
  double max_w() const noexcept { return max_w_; }

 private:
  friend class BeamInterlock;
  Permit(std::uint64_t tick, std::int64_t made_ns, std::int64_t end_ns, double max_w) noexcept
      : tick_(tick), made_ns_(made_ns), end_ns_(end_ns), max_w_(max_w) {}
  void take(Permit& other) noexcept {
    tick_ = std::exchange(other.tick_, 0);
    made_ns_ = std::exchange(other.made_ns_, 0);
    end_ns_ = std::exchange(other.end_ns_, 0);
    max_w_ = std::exchange(other.max_w_, 0.0);
  }

  std::uint64_t tick_ = 0;
  std::int64_t made_ns_ = 0;
  std::int64_t end_ns_ = 0;
  double max_w_ = 0.0;
};

}  // namespace telekerf::laser
