// SPDX-License-Identifier: Apache-2.0
// From the samples of one axis to its integers: which polynomial, which coefficients, which step.
#pragma once

#include <span>

#include "common/codec/axis_bits.h"

namespace telekerf::codec {

/// What an axis may cost: `keep` coefficients, or (max_rms above 0) any number that keeps the RMS error.
struct CodingTarget {
  int keep = 4;
  double max_rms = 0.0;
};

/// A code and what it costs: bits, and without a promised RMS error the error's energy as the bits that it is
/// worth.
struct PricedCode {
  AxisCode code;
  double cost_bits = 0.0;
};

/// Precomputed for one block length: the polynomials in the transform's domain, so that every prediction is
/// tried on the coefficients of one single transform (the transform is linear).
class Analyser {
 public:
  /// `integrated`: coefficients count by what they do to the samples' second integral.
  Analyser(int block, bool integrated);

  /// The cheapest code that keeps `target.max_rms` (bits decide), or the best with `target.keep` coefficients
  /// (error energy decides, bits break near-ties). Samples are finite and within kMaxMagnitude. With
  /// `context.truncated` it is the predecessor: no prediction, the lowest coefficients.
  PricedCode analyse(std::span<const double> samples, const CodingTarget& target, const AxisContext& context,
                     const Grid& grid) const noexcept;

 private:
  using Coefficients = std::array<double, kMaxBlock>;
  struct Fit {
    Mode mode = Mode::kIntra;
    std::int64_t slope = 0;
    std::int64_t bend = 0;
  };
  struct Choice {
    AxisCode code;
    double cost = 0.0;
    bool found = false;
  };

  enum class Trial { kInfeasible, kDearer, kTaken };

  int fits(std::span<const double> coefficients, int from, const AxisContext& context, const Grid& grid,
           std::span<Fit> found) const noexcept;
  void residual(std::span<const double> coefficients, const AxisCode& code, double level_coefficient,
                const Grid& grid, Coefficients& out) const noexcept;
  /// Both take the code over into `best` when it costs less.
  void try_fixed(std::span<const double> residual, AxisCode& code, int keep, const AxisContext& context,
                 const Grid& grid, Choice& best) const noexcept;
  Trial try_adaptive(std::span<const double> residual, AxisCode& code, int offset, double max_rms,
                     bool prefix, const AxisContext& context, const Grid& grid, Choice& best) const noexcept;
  void try_run_length(std::span<const double> samples, const CodingTarget& target, const AxisContext& context,
                      const Grid& grid, Choice& best) const noexcept;

  int block_;
  const Dct* dct_;
  bool integrated_;
  Coefficients weight_{};    // of a coefficient beside the mean's
  Coefficients ramp_{};      // DCT of n
  Coefficients parabola_{};  // DCT of n^2 / 2
};

}  // namespace telekerf::codec
