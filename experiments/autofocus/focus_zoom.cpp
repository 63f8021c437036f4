// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_zoom.h"

#include <fmt/format.h>

#include "common/runtime/startup_error.h"
#include "experiments/draw.h"

namespace telekerf::experiments {
namespace {

using namespace imaging;

constexpr double kTexel_m = 1e-5;

}  // namespace

Calibration calibrated_unit(std::uint64_t seed) {
  VirtualUnitSettings settings;
  settings.seed = settings.microscope.seed = seed;
  settings.microscope.picture = {640, 480};
  settings.microscope.dust_specks = 6;
  settings.magnification_m = 0.01;
  settings.focus_m = 0.012;
  const CalibrationSettings wanted;
  Object grid;
  grid.metres_per_texel = kTexel_m;
  grid.texture = draw_target(Target::kGrid, 1801, wanted.pitch_m / kTexel_m, seed);
  grid.height_m = 1e-3;
  VirtualUnit unit(settings, grid);

  ImagingModel known = ImagingModel();
  known.log_scale[0] += 0.1;
  const CalibrationRig rig{
      .zoom = [&](double to_m) -> tl::expected<void, std::string> {
        unit.control().move_to(kMagnification, to_m);
        if (!unit.settle()) return tl::unexpected<std::string>("the axis does not arrive");
        return {};
      },
      .look = [&](double to_m) -> tl::expected<cv::Mat, std::string> { return unit.look(to_m); },
      .positions = [&] { return unit.measured_m(); },
      .lowest_m = unit.control().lowest_m(),
      .highest_m = unit.control().highest_m(kFocus)};
  auto calibration = calibrate(rig, known, wanted);
  if (!calibration) throw input_error(calibration.error());
  return *calibration;
}

std::vector<ZoomStep> zoom_steps(Target target, std::uint64_t seed, int steps,
                                 const ImagingModel& calibrated) {
  Draw draw(seed * 7919 + static_cast<std::uint64_t>(target));
  VirtualUnitSettings settings;
  settings.seed = settings.microscope.seed = seed;
  settings.microscope.read_noise = draw.between(1.0, 6.0);
  settings.microscope.shot_noise = draw.between(1.0, 6.0);
  settings.microscope.dust_specks = draw.one_in(2) ? 6 : 0;
  settings.magnification_m = 0.01;
  settings.focus_m = 0.013 + draw.between(-3e-3, 3e-3);
  Object object;
  object.metres_per_texel = kTexel_m;
  object.texture = draw_target(target, 1024, 1.5, seed);
  object.height_m = draw.between(-3e-3, 3e-3);  // another workpiece than the calibration's grid
  VirtualUnit unit(settings, object);
  Autofocus autofocus({}, calibrated, unit.control().lowest_m(), unit.control().highest_m(kFocus));
  const auto to = [&](double magnification_m) {
    unit.control().move_to(kMagnification, magnification_m);
    unit.settle();
    focus_now(unit, autofocus);
  };
  for (const double magnification_m : {0.01, 0.03, 0.055, 0.075}) to(magnification_m);
  std::vector<ZoomStep> out;
  for (int i = 0; i < steps; ++i) {
    to(draw.between(2e-3, 78e-3));
    const double scale = autofocus.metres_per_pixel(unit.measured_m()) / unit.metres_per_pixel() - 1.0;
    out.push_back({autofocus.result().found(), autofocus.pictures(), unit.defocus_dof(), scale});
  }
  return out;
}

}  // namespace telekerf::experiments
