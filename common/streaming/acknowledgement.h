// SPDX-License-Identifier: Apache-2.0
// Delay-free by acknowledgement: the slave's state stream says which commands it applied and when, so that
// the master estimates neither clock nor delay. Both ends of that.
#pragma once

#include <cstdint>

#include "common/protocol/messages.h"

namespace telekerf::streaming {

/// What a slave's control step did with the command stream.
enum class Applied : std::uint8_t {
  kSample,     ///< it followed a sample that really came
  kConcealed,  ///< it followed what bridges a gap: the last acknowledgement stands as it is
  kNothing,    ///< it followed no sample
};

/// Of one control step or one state sample.
struct Acknowledgement {
  std::int64_t index = -1;   ///< newest command sample applied; negative: none yet
  std::int64_t age = 0;      ///< steps, or samples, since then; 0: just now
  std::uint64_t bitmap = 0;  ///< bit n: sample index - n was really applied
};

/// The slave's end. It has one verb, so it can be neither forgotten (a state block cannot be described
/// without what it returns) nor called in a wrong order.
class AcknowledgementLog {
 public:
  /// Every control step, once. `index`: of the sample that was due; `begins`: the command stream began anew
  /// since the last step.
  [[nodiscard]] Acknowledgement step(Applied applied, std::int64_t index, bool begins) noexcept {
    if (begins) {
      last_.index = -1;
      last_.bitmap = 0;
    }
    if (applied == Applied::kNothing) ++last_.age;
    if (applied == Applied::kSample) {
      last_.age = 0;
      if (index > last_.index) {  // otherwise the play-out waited: the same sample twice
        const std::int64_t shift = index - last_.index;
        last_.bitmap = (shift < 64 ? last_.bitmap << shift : 0) | 1U;
        last_.index = index;
      }
    }
    return last_;
  }

 private:
  Acknowledgement last_;
};

/// `ticks_per_sample`: of the command stream.
inline void write(const Acknowledgement& acknowledgement, std::uint16_t ticks_per_sample,
                  StateHeader& header) noexcept {
  header.applied_tick =
      acknowledgement.index < 0 ? 0 : static_cast<Tick>(acknowledgement.index) * ticks_per_sample;
  header.applied_age_ticks = static_cast<std::uint32_t>(acknowledgement.age);
  header.applied_bitmap = acknowledgement.bitmap;
}

/// The master's end: at the block's last sample, ages in the state stream's samples.
inline Acknowledgement read(const StateHeader& header, int ticks_per_sample) noexcept {
  return {static_cast<std::int64_t>(header.applied_tick) / ticks_per_sample,
          static_cast<std::int64_t>(header.applied_age_ticks / header.ticks_per_sample),
          header.applied_bitmap};
}

/// The command that a sample of the state stream shows the effect of.
struct AppliedCommand {
  std::int64_t index = -1;
  bool applied = false;  ///< false: no command acted; `index` is the one that would have been due
};

/// `back`: samples before the one that `acknowledgement` is of. Before the newest applied command one sample
/// back is one index back; after it nothing was applied.
inline AppliedCommand applied_at(const Acknowledgement& acknowledgement, std::int64_t back) noexcept {
  const std::int64_t bit = back - acknowledgement.age;
  return {acknowledgement.index - bit,
          bit >= 0 && (bit >= 64 || ((acknowledgement.bitmap >> bit) & 1U) != 0)};
}

}  // namespace telekerf::streaming
