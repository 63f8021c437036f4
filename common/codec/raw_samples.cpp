// SPDX-License-Identifier: Apache-2.0
#include "common/codec/raw_samples.h"

#include <cmath>

namespace telekerf::codec {

AxisCode raw_code(std::span<const double> samples) noexcept {
  AxisCode code;
  code.mode = Mode::kRaw;
  for (std::size_t n = 0; n < samples.size(); ++n) code.raw[n] = static_cast<float>(samples[n]);
  return code;
}

bool read_raw_samples(BitReader& in, std::span<double> samples) noexcept {
  for (double& sample : samples) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(in.bits(kRawSampleBits)));
    if (!(std::abs(value) <= static_cast<float>(kMaxMagnitude))) return false;  // NaN too
    sample = static_cast<double>(value);
  }
  return !in.failed();
}

}  // namespace telekerf::codec
