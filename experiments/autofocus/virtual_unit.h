// SPDX-License-Identifier: Apache-2.0
// An imaging unit in virtual time: axes under their controller, and the microscope behind the play of its
// screws. Every picture that is taken is counted.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>

#include "slave/vision/imaging/autofocus.h"
#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/focus_search.h"
#include "slave/vision/imaging/microscope.h"
#include "slave/vision/imaging/simulated_axes.h"

namespace telekerf::experiments {

struct VirtualUnitSettings {
  imaging::AxesModel axes = imaging::default_axes();
  imaging::MicroscopeSettings microscope;
  double mismatch = 0.1;  ///< of the motors against the model
  double frame_period_s = 0.05;
  double magnification_m = 0.04;  ///< where the axes stand at the start
  double focus_m = 0.015;
  std::uint64_t seed = 1;
};

class VirtualUnit {
 public:
  VirtualUnit(const VirtualUnitSettings& settings, imaging::Object object);

  /// Goes on for `seconds`.
  void run(double seconds);
  /// Waits until both axes have arrived, at most 20 s. False: they have not.
  bool settle();
  /// Brings the focus to `position_m`, from below, and takes a picture there.
  cv::Mat look(double position_m);
  /// The next picture of the stream, axes moving or not.
  cv::Mat next_frame();

  imaging::AxesControl& control() noexcept { return control_; }
  imaging::SimulatedMicroscope& microscope() noexcept { return microscope_; }
  double time_s() const noexcept { return time_s_; }
  double frame_period_s() const noexcept { return settings_.frame_period_s; }
  int pictures() const noexcept { return pictures_; }
  imaging::AxisPositions measured_m() const noexcept { return control_.positions_m(); }
  /// The truth.
  imaging::AxisPositions optics_m() const noexcept { return axes_.optics_m(); }
  double defocus_dof() const noexcept { return microscope_.defocus_dof(axes_.optics_m()); }
  double metres_per_pixel() const noexcept { return microscope_.metres_per_pixel(axes_.optics_m()); }

  /// Where a search may go from here.
  imaging::FocusRange range(double depth_of_field_m) const noexcept;
  /// Done before every picture: the object moves, for example.
  std::function<void(double time_s, imaging::Object& object)> before_picture;

 private:
  void step();

  VirtualUnitSettings settings_;
  imaging::SimulatedAxes axes_;
  imaging::AxesControl control_;
  imaging::SimulatedMicroscope microscope_;
  double time_s_ = 0.0;
  std::int64_t steps_ = 0;
  int pictures_ = 0;
};

/// Runs a search to its end; true error is virtual_unit.defocus_dof() afterwards, when the focus stands where
/// the result says.
imaging::FocusResult run_search(VirtualUnit& unit, imaging::FocusSearch search);

/// Lets the autofocus work until it tracks or gives up; the focus then stands where it wants it.
void focus_now(VirtualUnit& unit, imaging::Autofocus& autofocus);

/// The autofocus on the stream of pictures, as vision has it: a picture counts where both axes stood still
/// since the one before.
class LiveFocus {
 public:
  LiveFocus(VirtualUnit& unit, imaging::Autofocus& autofocus) : unit_(unit), autofocus_(autofocus) {}

  /// The next picture of the stream. True: it counted, in focus and nothing being tried.
  bool step(const cv::Mat& picture, bool zooming);

 private:
  VirtualUnit& unit_;
  imaging::Autofocus& autofocus_;
  bool arrived_ = false;
};

}  // namespace telekerf::experiments
