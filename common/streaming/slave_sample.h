// SPDX-License-Identifier: Apache-2.0
// What the state stream is to the master's estimators.
#pragma once

#include <cstdint>

#include "common/runtime/vectors.h"

namespace telekerf::streaming {

/// One measured state of the slave with the command that it was applying when it was measured.
struct SlaveSample {
  std::int64_t index = -1;  ///< of the command stream
  std::int64_t time = 0;    ///< the slave's own count of samples
  bool applied = false;     ///< false: nothing was applied; the slave coasted, slowed down or held its pose
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
};

}  // namespace telekerf::streaming
