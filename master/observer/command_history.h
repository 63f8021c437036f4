// SPDX-License-Identifier: Apache-2.0
// What was sent and not forgotten yet: the commands of the last seconds by their stream index, after clipping
// and after decoding, each with the state that the model held when it was made.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "common/control/kinematic_state.h"
#include "common/protocol/messages.h"
#include "common/streaming/slave_sample.h"

namespace telekerf::master {

using control::advanced;
using control::KinematicState;
using streaming::SlaveSample;

/// One stream sample's command. `model`: the state at this index on which `model.acceleration` acts next.
struct SentCommand {
  std::int64_t index = -1;
  KinematicState model;
};

/// Stream index = master tick / ticks per sample. Fixed memory; older commands are overwritten.
class CommandHistory {
 public:
  static constexpr std::size_t kSize = 8192;  ///< 8 s at 1 kHz

  CommandHistory() : slots_(std::make_unique<std::array<SentCommand, kSize>>()) {}
  void store(std::int64_t index, const KinematicState& model) noexcept { slot(index) = {index, model}; }
  const SentCommand* find(std::int64_t index) const noexcept {
    const SentCommand& found = slot(index);
    return index >= 0 && found.index == index ? &found : nullptr;
  }
  /// m/s^2; zero for an index that was never sent.
  Vec3 acceleration(std::int64_t index) const noexcept {
    const SentCommand* found = find(index);
    return found == nullptr ? Vec3::Zero() : found->model.acceleration_m_per_s2;
  }

 private:
  SentCommand& slot(std::int64_t index) const noexcept {
    return (*slots_)[static_cast<std::size_t>(index) % kSize];
  }
  std::unique_ptr<std::array<SentCommand, kSize>> slots_;
};

}  // namespace telekerf::master
