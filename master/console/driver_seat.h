// SPDX-License-Identifier: Apache-2.0
// Who drives: one page at a time holds the hand, by a lease with a number. All others watch.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "master/console/page_protocol.h"
#include "master/operator/operator_lease.h"
#include "master/operator/udp_hand.h"

namespace telekerf::master {

/// Pure: time is what it is told. Pages are numbers.
class DriverSeat {
 public:
  /// A page from which nothing is heard for this long has lost the seat.
  static constexpr std::int64_t kAbsent_ns = 2'000'000'000;

  /// `seed`: of the leases' numbers, so that those of an earlier server count for nothing.
  explicit DriverSeat(std::uint32_t seed) noexcept : lease_(seed) {}

  /// The lease's number; none: somebody else drives.
  std::optional<std::uint32_t> take(std::uint32_t page, std::int64_t now_ns) noexcept;
  /// Does nothing if this page does not drive.
  void leave(std::uint32_t page) noexcept;
  /// Nobody drives any more.
  void vacate() noexcept;
  /// Ends a lease that nothing is heard of.
  void step(std::int64_t now_ns) noexcept;
  bool drives(std::uint32_t page) const noexcept { return page_ == page; }
  bool taken() const noexcept { return page_.has_value(); }
  std::uint32_t lease() const noexcept { return lease_; }

  /// The fire button counts. Never longer than the lease, nor beyond a stop.
  bool armed() const noexcept { return armed_; }
  void arm(bool armed) noexcept { armed_ = armed && taken(); }

  /// What the master's hand is to hear of it; none: not the driver's, of another lease, too old or overtaken.
  std::optional<UdpHandFrame> hear(std::uint32_t page, const PageFrame& frame, std::int64_t now_ns) noexcept;
  /// Frames that came too late, of all leases.
  std::uint64_t late() const noexcept { return gate_.counters().late; }

  /// Of a frame that was passed on, by its number in the lease. None: forgotten.
  struct Passed {
    std::uint32_t sequence = 0;
    double page_ms = 0.0;
    std::int64_t heard_ns = 0;
  };
  std::optional<Passed> passed(std::uint32_t lease, std::uint64_t sequence) const noexcept;

 private:
  std::optional<std::uint32_t> page_;
  std::uint32_t lease_;
  std::int64_t heard_ns_ = 0;
  bool armed_ = false;
  OperatorLease gate_;
  std::array<Passed, 256> passed_{};
};

}  // namespace telekerf::master
