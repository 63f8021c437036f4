// SPDX-License-Identifier: Apache-2.0
// From the samples of one axis to its integers: which polynomial, which coefficients, which step.
#pragma once

#include <span>

#include "common/codec/axis_bits.h"

namespace telekerf::codec {

/// What an axis may cost: `keep` coefficients, or (max_rms above 0) any number that keeps the RMS error.
struct Aim {
  int keep = 4;
  double max_rms = 0.0;
};

/// Precomputed for one block length: the polynomials in the transform's domain, so that every prediction is
/// tried on the coefficients of one single transform (the transform is linear).
class Analyser {
 public:
  explicit Analyser(int block);

  /// The cheapest code that keeps `aim.max_rms` (bits decide), or the best with `aim.keep` coefficients
  /// (error energy decides, bits break near-ties). Samples are finite and within kMaxMagnitude.
  AxisCode analyse(std::span<const double> samples, const Aim& aim, const AxisContext& context,
                   const Grid& grid) const noexcept;

 private:
  struct Fit {
    Mode mode = Mode::kIntra;
    std::int64_t slope = 0;
    std::int64_t bend = 0;
  };
  struct Candidate {
    AxisCode code;
    double energy = 0.0;  // squared error of the block
    int bits = 0;
    bool feasible = false;
  };

  int fits(std::span<const double> coefficients, int from, const AxisContext& context, const Grid& grid,
           std::span<Fit> found) const noexcept;
  Candidate fixed(std::span<const double> residual, AxisCode code, int keep, const AxisContext& context,
                  const Grid& grid) const noexcept;
  Candidate adaptive(std::span<const double> residual, AxisCode code, int offset, double max_rms,
                     const AxisContext& context, const Grid& grid) const noexcept;

  int block_;
  const Dct* dct_;
  std::array<double, kMaxBlock> ramp_{};      // DCT of n
  std::array<double, kMaxBlock> parabola_{};  // DCT of n^2 / 2
};

}  // namespace telekerf::codec
