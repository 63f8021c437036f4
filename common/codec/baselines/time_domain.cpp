// SPDX-License-Identifier: Apache-2.0
#include "common/codec/baselines/time_domain.h"

namespace telekerf::codec {

double allowed_energy(std::span<const double> samples, const StreamSettings& settings) noexcept {
  return settings.max_rms * settings.max_rms * static_cast<double>(samples.size()) * (1.0 - 1e-9);
}

void reconstruct_multiples(const AxisCode& code, const Grid& grid, std::span<double> samples) noexcept {
  const double step = grid.step(code.step_offset);
  for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = step * static_cast<double>(code.values[n]);
}

}  // namespace telekerf::codec
