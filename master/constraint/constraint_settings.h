// SPDX-License-Identifier: Apache-2.0
// What a user can choose about the virtual constraint.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/runtime/enum_table.h"
#include "master/haptics/felt_cut.h"

namespace telekerf::master {

/// What stands for the curve around the tool.
enum class CurveKind : std::uint8_t {
  kCircles,     ///< least-squares circles through 2k + 1 points (Algorithm 1)
  kLines,       ///< least-squares lines through the same points
  kDescriptor,  ///< osculating circles of the smooth elliptic Fourier curve (closed contours)
};
inline constexpr EnumRow<CurveKind> kCurveRows[] = {
    {"circles", CurveKind::kCircles, "least-squares circles through the points around the tool"},
    {"lines", CurveKind::kLines, "least-squares lines through the same points"},
    {"descriptor", CurveKind::kDescriptor, "a smooth elliptic Fourier curve; closed contours only"},
};
inline constexpr EnumTable<CurveKind> kCurves(kCurveRows);

struct ConstraintSettings {
  // The curve. Lengths marked "at the work" are of the contour itself; the master's are beta times smaller or
  // larger.
  CurveKind curve = CurveKind::kCircles;
  int half_window = 24;            ///< k of eq. 15, points to either side at most
  double spacing_m = 0.0125e-3;    ///< between the points of the guide, at the work
  double rounding_m = 0.012e-3;    ///< corners are rounded by a Gaussian of this width, at the work
  double min_radius_m = 0.012e-3;  ///< smallest radius of a bend, at the work
  double opening_m = 0.2e-3;       ///< farthest that a point moves for that, at the work
  double window_bend_rad = 0.7;    ///< fewer points where the curve bends by more than this to either side
  bool taper = true;               ///< false: all points count the same, as eq. 18 is printed
  double descriptor_error_m = 2.5e-6;  ///< largest deviation of the descriptor from the contour, at the work

  // Across it.
  double bandwidth_rad_s = 150.0;  ///< of the error decay across the curve and in z (eq. 65)
  double damping = 1.0;
  double period_s = 1e-3;        ///< of the control step: the gains give this decay when sampled
  double return_m_per_s = 0.05;  ///< fastest way back to the curve, whatever the distance
  double entry_s = 0.3;          ///< what is left of an entry or a change of mode has faded after this

  // Along it.
  double mass_kg = 0.5;            ///< virtual mass that the hand moves
  double damping_n_s_per_m = 2.0;  ///< virtual damping
  double force_deadband_n =
      0.15;  ///< estimated forces below this do not move the tool: errors of the estimate are as large
  double end_bandwidth_rad_s = 300.0;  ///< of the stops at the ends of an open curve
  double end_m_per_s = 3e-3;           ///< at which they are met at most

  FeltCutSettings felt;                ///< what of the cut the hand feels

  // Bends: the tool is held back before it could be thrown off.
  double max_speed_m_per_s = 0.2;  ///< on straight stretches
  double bend_m_per_s2 = 1.0;      ///< largest v^2 curvature
  double bend_rad_s = 40.0;        ///< largest v curvature
  double bend_m_per_s3 = 60.0;     ///< largest v^3 times the change of the curvature along the curve
  double slowing_m_per_s2 = 0.8;   ///< how hard it is braked before a bend

  // The forbidden-region fixture: inside the corridor the hand moves freely in the plane.
  double corridor_m = 0.0;         ///< half width; 0: guidance, the tool is held on the curve
  double stiffness_n_per_m = 0.0;  ///< inside the corridor, towards the curve: between free and guided
  double wall_skin_m = 0.05e-3;    ///< over which the wall sets in
};

/// No bend of the guide is tighter than this, in the master's size: a hand's push displaces the tool by as
/// much, and where that is more than the radius the guide has no side any more.
inline constexpr double kTightest_m = 7e-6;

/// The same for a master whose motion is scaled by `beta`: all lengths in the master's size.
inline ConstraintSettings in_masters_size(ConstraintSettings settings, double beta) noexcept {
  for (double* length_m : {&settings.spacing_m, &settings.rounding_m, &settings.min_radius_m,
                           &settings.opening_m, &settings.descriptor_error_m}) {
    *length_m /= beta;
  }
  for (double* length_m : {&settings.spacing_m, &settings.rounding_m, &settings.min_radius_m})
    *length_m = std::max(*length_m, kTightest_m);
  return settings;
}

}  // namespace telekerf::master
