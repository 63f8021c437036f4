// SPDX-License-Identifier: Apache-2.0
// Who else puts blocks on the slave's network: one who forges them, one who plays recorded ones again.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/codec/encoder.h"
#include "common/protocol/messages.h"
#include "experiments/chaos/checker.h"
#include "experiments/chaos/fault.h"

namespace telekerf::experiments {

/// A command block on its way.
struct Datagram {
  CommandBlock block;
  bool genuine = false;      ///< of a master, not of an attacker
  std::int64_t born_ns = 0;  ///< true time at which its newest sample was made
};

/// Copies what a true block says (epoch, contour, whatever else is in its head), so that it is taken for one:
/// button held, zero accelerations, on one spot; numbers counted up, as far ahead as they go, or the last one
/// there is.
class Forger {
 public:
  /// `codec`: of the true stream.
  explicit Forger(const codec::StreamSettings& codec) : encoder_(codec), block_samples_(codec.block) {}
  void saw(const CommandBlock& block) { seen_ = block; }
  /// What it sends at `now_ns`, every millisecond; registers when that was made.
  void step(std::int64_t now_ns, const FaultWindow& window, BirthRegister& births,
            std::vector<Datagram>& out);

 private:
  codec::BlockEncoder encoder_;
  int block_samples_;
  std::optional<CommandBlock> seen_;
  std::int64_t next_ns_ = 0;
  std::uint32_t forged_ = 0;
  double window_from_s_ = -1.0;
  Anchor spot_;
};

/// Keeps the last seconds; plays them again at their own pace.
class Replayer {
 public:
  void saw(std::int64_t now_ns, const CommandBlock& block);
  void step(std::int64_t now_ns, const FaultWindow& window, BirthRegister& births,
            std::vector<Datagram>& out);

 private:
  struct Recorded {
    std::int64_t at_ns;
    CommandBlock block;
  };
  std::deque<Recorded> tape_;
  std::vector<Recorded> played_;
  double window_from_s_ = -1.0;
  std::int64_t began_ns_ = 0;
  std::size_t next_ = 0;
};

}  // namespace telekerf::experiments
