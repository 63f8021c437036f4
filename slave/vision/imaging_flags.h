// SPDX-License-Identifier: Apache-2.0
// What a user says of an imaging unit, and the camera or the calibration that comes of it.
#pragma once

#include <memory>
#include <string>

#include "common/runtime/settings.h"
#include "slave/vision/cameras/imaging_camera.h"

namespace telekerf::vision_process {

struct ImagingFlags {
  std::string imaging = "none";
  std::string imaging_file;
  imaging::FocusLaw law = imaging::FocusLaw::kSearch;
  double zoom = 0.3;
  double focus_region = 1.0;
  std::string calibrate;
  double grid_mm = 1.0;

  void add_parameters(Settings& settings);
  bool wanted() const { return imaging != "none"; }
  /// Of real axes without a file: that the sizes are another unit's. Empty: nothing to warn of.
  std::string warning() const;
};

/// The camera above the axes that `flags` name: the simulated microscope over `image` (`width_m` wide, 0: 30
/// mm), or with other axes what `camera` shows. Throws StartupError.
std::unique_ptr<ImagingCamera> open_imaging(const ImagingFlags& flags, const std::string& image,
                                            double width_m, const std::string& camera);

/// Calibrates the unit with the printed grid under it (of a simulated unit: its own) and writes the file that
/// `flags.calibrate` names. Says what it found. Throws StartupError if it cannot.
void run_calibration(const ImagingFlags& flags, const std::string& camera);

}  // namespace telekerf::vision_process
