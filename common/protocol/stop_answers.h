// SPDX-License-Identifier: Apache-2.0
// What the stations say of the stops that they obey: who has answered, who is missing.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "common/protocol/presence.h"
#include "common/protocol/stop_latch.h"

namespace telekerf {

/// The roles that have to obey a stop.
bool is_station(const PresenceMessage& process);

class StopAnswers {
 public:
  void hear(const StopMessage& message);
  /// That this stop is in force for it; or over, if not `set`.
  bool said(const PresenceMessage& station, std::uint32_t number, bool set) const {
    return said_.contains({station.epoch, number, set});
  }
  /// Of the stations among `others`, those that have not said that this stop is in force (or over, if not
  /// `set`) for them; into `told` go those that have.
  std::vector<std::string> missing(std::span<const PresenceMessage> others, std::uint32_t number, bool set,
                                   std::vector<std::string>& told) const;
  /// As the stations have told.
  const std::vector<StopLatch::Entry>& in_force() const noexcept { return latch_.in_force(); }

 private:
  StopLatch latch_;
  std::set<std::tuple<std::uint32_t, std::uint32_t, bool>> said_;  ///< epoch, number, set
};

}  // namespace telekerf
