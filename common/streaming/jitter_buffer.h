// SPDX-License-Identifier: Apache-2.0
// Where samples wait until they are due: the newest of the command stream, each at its place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/control/kinematic_state.h"
#include "common/protocol/messages.h"
#include "common/streaming/lost_time.h"
#include "common/streaming/packet_samples.h"

namespace telekerf::streaming {

using control::KinematicState;

/// What the master said about one stream sample.
struct StreamSample {
  Vec3 value = Vec3::Zero();  ///< position (m); of a bare acceleration stream nothing
  bool button = false;
  bool engaged = false;
  /// Changes with epoch, law and beta: samples of two generations are not comparable.
  std::uint32_t generation = 0;
  std::uint32_t block = 0;  ///< an anchored stream goes from one anchor to the next
  Law law = Law::kLocal;
  Vec3 velocity_m_per_s = Vec3::Zero();       ///< of an anchored stream
  Vec3 acceleration_m_per_s2 = Vec3::Zero();  ///< held from this sample to the next; not of a local stream
  std::uint32_t engage = 0;                   ///< number of the engagement that leads it
  std::uint32_t echo_sequence = 0;  ///< state block that the master had when it began the sample's block
  std::int64_t echo_sent_ns = 0;    ///< its stamp; of a copy: no later than that, or there is no echo
  bool concealed = false;           ///< between known samples, but not itself known: never with the laser on
};

/// The newest stream samples by their index (master tick / ticks per sample); older ones are overwritten.
class JitterBuffer {
 public:
  static constexpr std::size_t kSize = 8192;

  void clear() noexcept;
  void store(std::int64_t index, const StreamSample& sample) noexcept;
  /// Every sample of a packet whose place is not known yet, with the state that the block's anchor gives it.
  /// `header`: the packet's.
  void store(const PacketSamples& samples, const CommandHeader& header, std::uint32_t generation) noexcept;
  const StreamSample* find(std::int64_t index) const noexcept;
  /// The first index that is there, from `index` to `newest`; none: nothing.
  std::optional<std::int64_t> first_from(std::int64_t index, std::int64_t newest) const noexcept;

 private:
  struct Slot {
    std::int64_t index = -1;
    StreamSample sample;
  };
  std::array<Slot, kSize> slots_{};
  LostTime lost_;
};

}  // namespace telekerf::streaming
