// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/calibration.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "slave/vision/imaging/autofocus.h"

namespace telekerf::imaging {
namespace {

constexpr double kMargin_m = 2e-3;     ///< of the magnification axis, from the ends of its travel
constexpr double kOffFocus_dof = 1.5;  ///< to either side, for what the focus does to the scale

tl::expected<FocusResult, std::string> focus(const CalibrationRig& rig, Autofocus& autofocus, double region) {
  while (true) {
    const double goal_m = autofocus.goal_m(rig.positions(), false);
    if (autofocus.state() != Autofocus::State::kSearching) break;
    const auto picture = rig.look(goal_m);
    if (!picture) return tl::unexpected(picture.error());
    autofocus.seen((*picture)(central_region(picture->size(), region)), rig.positions());
  }
  if (!autofocus.result().found()) {
    return tl::unexpected(fmt::format("no focus on the grid with the magnification axis at {:.2f} mm: {}",
                                      1e3 * rig.positions().magnification_m,
                                      kFocusVerdicts.word(autofocus.result().verdict)));
  }
  return autofocus.result();
}

tl::expected<GridView, std::string> view_at(const CalibrationRig& rig, double focus_m, double pitch_m) {
  const auto picture = rig.look(focus_m);
  if (!picture) return tl::unexpected(picture.error());
  return measure_grid(*picture, pitch_m);
}

/// ln(metres per pixel) over s, of third order if there are enough views.
void fit_scale(Calibration& calibration) {
  const auto count = static_cast<Eigen::Index>(calibration.views.size());
  const Eigen::Index order = std::min<Eigen::Index>(4, count);
  Eigen::MatrixXd terms(count, order);
  Eigen::VectorXd logs(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double s = calibration.places[k].magnification_m / calibration.model.magnification_travel_m;
    for (Eigen::Index j = 0; j < order; ++j) terms(i, j) = std::pow(s, j);
    logs[i] = std::log(calibration.views[k].metres_per_pixel);
  }
  const Eigen::VectorXd c = terms.colPivHouseholderQr().solve(logs);
  calibration.model.log_scale = {};
  for (Eigen::Index j = 0; j < order; ++j) calibration.model.log_scale[static_cast<std::size_t>(j)] = c[j];
  const Eigen::VectorXd off = terms * c - logs;
  calibration.scale_residual = off.cwiseAbs().maxCoeff();
}

}  // namespace

tl::expected<Calibration, std::string> calibrate(const CalibrationRig& rig, const ImagingModel& known,
                                                 const CalibrationSettings& settings) {
  Calibration out;
  out.model = known;
  Autofocus autofocus({}, known, rig.lowest_m, rig.highest_m);
  const double way_m = known.magnification_travel_m - 2.0 * kMargin_m;
  double focus_scale = 0.0;
  for (int i = 0; i < settings.magnifications; ++i) {
    const double share =
        settings.magnifications > 1 ? static_cast<double>(i) / (settings.magnifications - 1) : 0.5;
    if (const auto moved = rig.zoom(kMargin_m + share * way_m); !moved) return tl::unexpected(moved.error());
    const auto found = focus(rig, autofocus, settings.region);
    if (!found) return tl::unexpected(found.error());
    const auto view = view_at(rig, found->position_m, settings.pitch_m);
    if (!view) return tl::unexpected(view.error());
    out.places.push_back({rig.positions().magnification_m, found->position_m});
    out.views.push_back(*view);
    // What the focus does to the scale, from either side of it.
    const double off_m = kOffFocus_dof * known.depth_of_field_m(rig.positions().magnification_m);
    const auto below = view_at(rig, found->position_m - off_m, settings.pitch_m);
    if (!below) return tl::unexpected(below.error());
    const double below_m = rig.positions().focus_m;  // the axis may end before
    const auto above = view_at(rig, found->position_m + off_m, settings.pitch_m);
    if (!above) return tl::unexpected(above.error());
    const double apart_m = rig.positions().focus_m - below_m;
    focus_scale += (above->metres_per_pixel - below->metres_per_pixel) / (apart_m * view->metres_per_pixel);
  }
  const double count = settings.magnifications;
  out.model.focus_scale_per_m = focus_scale / count;
  out.model.distortion = 0.0;
  out.model.flat_field = {};
  for (const GridView& view : out.views) {
    out.model.distortion += view.distortion / count;
    for (std::size_t k = 0; k < 4; ++k) out.model.flat_field[k] += view.flat_field[k] / count;
  }
  fit_scale(out);
  autofocus.ridge().write_to(out.model);
  return out;
}

}  // namespace telekerf::imaging
