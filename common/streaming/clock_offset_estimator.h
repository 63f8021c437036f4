// SPDX-License-Identifier: Apache-2.0
// Two machines' monotonic clocks, compared by the four stamps that ride on the normal messages. For
// telemetry, logs and one-way delays only, never inside the loop: half the link's asymmetry is unobservable.
#pragma once

#include <array>
#include <cstdint>

namespace telekerf::streaming {

/// Master sent, slave received, slave answered, master received; each by its own clock.
struct FourStamps {
  std::int64_t t1_ns = 0;
  std::int64_t t2_ns = 0;
  std::int64_t t3_ns = 0;
  std::int64_t t4_ns = 0;
};

struct ClockEstimate {
  double offset_s = 0.0;       ///< slave's clock minus the master's, now
  double skew = 0.0;           ///< by which the slave's clock runs faster, s/s
  double uncertainty_s = 0.0;  ///< half the shortest delay (all of it could be asymmetry) + the fit's scatter
};

/// Delay-weighted least squares over the last 200 exchanges: offset = ((t2-t1)+(t3-t4))/2,
/// delay = (t4-t1)-(t3-t2), weight 1/(delay - shortest + 100 us)^2, because a queue delays one way only.
class ClockOffsetEstimator {
 public:
  void add(const FourStamps& stamps) noexcept;
  /// At `now_ns` of the master's clock; zero before the second exchange.
  ClockEstimate estimate(std::int64_t now_ns) const noexcept;
  int exchanges() const noexcept { return count_; }

 private:
  struct Exchange {
    std::int64_t at_ns = 0;  ///< master's clock, middle of the exchange
    std::int64_t offset_ns = 0;
    std::int64_t delay_ns = 0;
  };
  static constexpr int kWindow = 200;
  std::array<Exchange, kWindow> exchanges_{};
  int count_ = 0;
  int next_ = 0;
};

}  // namespace telekerf::streaming
