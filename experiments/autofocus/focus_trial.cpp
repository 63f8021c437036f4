// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_trial.h"

#include <cmath>

#include "experiments/draw.h"

namespace telekerf::experiments {

using namespace imaging;

DrawnStart draw_start(const FocusStart& start) {
  Draw draw(start.seed * 1'000'003 + 17 * static_cast<std::uint64_t>(start.target) +
            257 * static_cast<std::uint64_t>(start.kind));
  VirtualUnitSettings settings;
  settings.seed = start.seed;
  MicroscopeSettings& scope = settings.microscope;
  scope.seed = start.seed;
  scope.read_noise = draw.between(1.0, 6.0);
  scope.shot_noise = draw.between(1.0, 6.0);
  scope.dust_specks = draw.one_in(2) ? 6 : 0;
  scope.dust_dof = draw.one_in(2) ? 6.0 : -6.0;
  settings.magnification_m = draw.between(2e-3, scope.model.magnification_travel_m - 2e-3);
  const double focus_m = scope.model.best_focus_m(settings.magnification_m);
  const double dof_m = scope.model.depth_of_field_m(settings.magnification_m);
  settings.focus_m = focus_m + draw.between(-10.0, 10.0) * dof_m;

  Object object;
  // The finest structure is a pixel wide at the magnification of the start.
  object.metres_per_texel = scope.model.metres_per_pixel({settings.magnification_m, focus_m});
  object.texture = draw_target(start.target, 512, 1.0, start.seed);
  object.x_m = draw.between(-200.0, 200.0) * object.metres_per_texel;
  object.y_m = draw.between(-200.0, 200.0) * object.metres_per_texel;
  if (start.kind == StartKind::kOutOfRange)
    object.height_m = (draw.one_in(2) ? 1.0 : -1.0) * draw.between(30.0, 45.0) * dof_m;

  DrawnStart out;
  out.unit = std::make_unique<VirtualUnit>(settings, object);
  if (start.kind == StartKind::kMoving) {
    const int way = static_cast<int>(start.seed % 3);
    const double pixels_a_frame = draw.between(0.5, 4.0);
    const double shake_dof = draw.between(2.0, 6.0);
    const double phase = draw.between(0.0, 6.28);
    const double creep_dof_a_frame = draw.between(0.15, 0.5);
    out.unit->before_picture = [=, still = object](double time_s, Object& now) {
      const double frames = time_s / settings.frame_period_s;
      if (way == 0) now.x_m = still.x_m + pixels_a_frame * frames * still.metres_per_texel;
      if (way == 1) now.height_m = still.height_m + shake_dof * dof_m * std::sin(phase + 6.0 * time_s);
      if (way == 2) now.height_m = still.height_m + creep_dof_a_frame * frames * dof_m;
    };
  }
  out.range = out.unit->range(dof_m);
  out.range.peak_width_dof =
      peak_width_dof(scope.model.optics, scope.model.magnification(settings.magnification_m));
  return out;
}

FocusOutcome by_search(VirtualUnit& unit, const FocusRange& range) {
  const FocusResult result = run_search(unit, FocusSearch::everywhere({}, range, {}));
  return {result.found(), result.verdict, result.pictures, unit.defocus_dof()};
}

}  // namespace telekerf::experiments
