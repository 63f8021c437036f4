// SPDX-License-Identifier: Apache-2.0
// What each window of a schedule does to the world where it begins and where it ends. What the link does is
// in its profile already.
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/chaos/fault.h"
#include "experiments/chaos/world.h"

namespace telekerf::experiments {

class Injection {
 public:
  explicit Injection(const Schedule& schedule)
      : schedule_(schedule), begun_(schedule.windows.size(), false), ended_(schedule.windows.size(), false) {}

  /// Whatever begins or ends by `now_ns`, true time.
  void turn(std::int64_t now_ns, World& world);
  /// Windows of attackers that hold now.
  const std::vector<FaultWindow>& attacks() const noexcept { return attacks_; }

 private:
  void begin(std::int64_t now_ns, const FaultWindow& window, World& world);
  void end(std::int64_t now_ns, const FaultWindow& window, World& world);

  const Schedule& schedule_;
  std::vector<bool> begun_, ended_;
  std::vector<FaultWindow> attacks_;
};

}  // namespace telekerf::experiments
