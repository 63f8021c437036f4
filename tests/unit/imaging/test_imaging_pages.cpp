// SPDX-License-Identifier: Apache-2.0
// The pages' tables of settings hold what the code is set to.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "common/reporting/page_tables.h"
#include "slave/vision/imaging/autofocus.h"
#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/calibration.h"
#include "slave/vision/imaging/imaging_file.h"
#include "slave/vision/imaging/microscope.h"

namespace telekerf::imaging {
namespace {

using reporting::TableRows;

/// Every key of an imaging file, as an empty one is read.
TableRows keys() {
  TableRows out{{"key", "without it"}};
  std::istringstream toml(imaging_toml(parse_imaging("", "empty")));
  std::string table;
  for (std::string line; std::getline(toml, line);) {
    if (line.starts_with("[")) table = line.substr(1, line.size() - 2);
    const std::size_t equals = line.find(" = ");
    if (equals == std::string::npos) continue;
    out.push_back({fmt::format("`{}.{}`", table, line.substr(0, equals)), line.substr(equals + 3)});
  }
  return out;
}

TableRows settings() {
  const AutofocusSettings all;
  const FocusSearchSettings& search = all.search;
  const FocusTrackerSettings& tracker = all.tracker;
  const CalibrationSettings calibration;
  const AxesControlSettings axes;
  const MicroscopeSettings microscope;
  TableRows out{{"setting", "value"}};
  const auto add = [&](const char* name, double value) { out.push_back({name, fmt::format("{:g}", value)}); };
  add("coarse sweep, to either side, dof", search.reach_dof);
  add("its step, dof", search.coarse_dof);
  add("step of the fine sweep, dof", search.fine_dof);
  add("its pictures", search.fine_pictures);
  add("step about the ridge, dof", search.near_dof);
  add("its pictures", search.near_pictures);
  add("rise of a peak, share", search.min_rise);
  add("tiles that become sharper, share", search.min_support);
  add("the same of a line, share", search.min_line_support);
  add("tiles that a line reaches across", search.min_span);
  add("width of a peak at the least, of the optics'", search.min_width);
  add("and at the most", search.max_width);
  add("fall of the second look, share", search.max_fall);
  add("tiles left out, those of the largest values", kTrimmedTiles);
  add("ridge that is known, standard deviation, dof", all.ridge_known_dof);
  add("magnification that has not been moved, mm", 1e3 * all.same_zoom_m);
  add("window of the tracking, dof", tracker.window_dof);
  add("its largest step (mu_0), dof", tracker.mu_0_dof);
  add("share of the way that a step goes", tracker.convergence);
  add("pictures at rest, the first time", tracker.rest_pictures);
  add("and at the most", tracker.longest_rest_pictures);
  add("step after which it rests, dof", tracker.small_dof);
  add("fall that ends the rest, share", tracker.fall);
  add("sharpness of the lock below which it is lost, share", tracker.lost);
  add("magnifications of a calibration", calibration.magnifications);
  add("part of the picture that it focuses by, share", calibration.region);
  add("distance of its dots, mm", 1e3 * calibration.pitch_m);
  add("axes: period, ms", 1e3 * axes.period_s);
  add("axes: disturbance observer, rad/s", axes.observer_rad_per_s);
  add("axes: its velocity, rad/s", axes.velocity_observer_rad_per_s);
  add("axes: C of eq. 160, rad/s", axes.convergence_rad_per_s);
  add("axes: arrived within, um", 1e6 * axes.settled_m);
  add("axes: and slower than, mm/s", 1e3 * axes.settled_m_per_s);
  add("simulated: cubic part of the ridge, mm", 1e3 * microscope.ridge_cubic_m);
  add("simulated: read noise, grey levels", microscope.read_noise);
  add("simulated: shot noise at white, grey levels", microscope.shot_noise);
  add("simulated: light a dof, share", microscope.exposure_per_dof);
  add("simulated: light a second, share", microscope.exposure_per_s);
  add("simulated: layer of dust, dof", microscope.dust_dof);
  return out;
}

TEST(ImagingPages, HoldTheDefaultsOfEveryKey) {
  EXPECT_EQ(reporting::read_table(TELEKERF_IMAGING_PAGE, "keys"), keys())
      << reporting::markdown_table(keys());
}

TEST(ImagingPages, HoldWhatTheSearchIsSetTo) {
  EXPECT_EQ(reporting::read_table(TELEKERF_AUTOFOCUS_PAGE, "settings"), settings())
      << reporting::markdown_table(settings());
}

}  // namespace
}  // namespace telekerf::imaging
