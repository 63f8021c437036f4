// SPDX-License-Identifier: Apache-2.0
// The thesis' self-optimising law (eq. 156-158): a velocity towards larger sharpness, from its gradient over
// a window. What tracks the velocity is AxesControl (eq. 159-161).
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/runtime/enum_table.h"

namespace telekerf::imaging {

/// Eq. 158 for f = -S: mu_0 (1 - 2 / (1 + exp(-alpha g_f))) = mu_0 tanh(alpha g_S / 2). Unit: that of `mu_0`.
inline double optimizing_velocity(double sharpness_gradient, double mu_0, double alpha) noexcept {
  return mu_0 * std::tanh(0.5 * alpha * sharpness_gradient);
}

enum class FocusLaw : std::uint8_t { kSearch, kThesis };
inline constexpr EnumRow<FocusLaw> kFocusLawRows[] = {
    {"search", FocusLaw::kSearch, "a sweep finds the focus, the law on the logarithm keeps it"},
    {"thesis", FocusLaw::kThesis,
     "the self-optimising law as printed (eq. 156-161), from wherever it stands"},
};
inline constexpr EnumTable<FocusLaw> kFocusLaws(kFocusLawRows);

struct FocusLawSettings {
  double mu_0_m_per_s = 0.01;  ///< amplitude of the velocity
  double alpha = 1.0;          ///< metres per unit of sharpness: how sharply it changes sign at the peak
  double window_m = 0.25e-3;   ///< delta of eq. 157
};

/// As printed: the gradient is taken from the place one window behind to here (eq. 157), of the sharpness
/// itself. It is 0/0 where nothing has moved by a window yet: without excitation there is no velocity.
class PrintedFocusLaw {
 public:
  explicit PrintedFocusLaw(const FocusLawSettings& settings) : settings_(settings) {}

  /// A picture at `position_m` of this sharpness (eq. 155): the velocity until the next one, m/s.
  double step(double position_m, double sharpness);

 private:
  struct Sample {
    double position_m, sharpness;
  };
  FocusLawSettings settings_;
  std::vector<Sample> samples_;  ///< newest last
};

}  // namespace telekerf::imaging
