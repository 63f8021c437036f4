// SPDX-License-Identifier: Apache-2.0
// The file of an imaging unit (TOML): optics, axes, and what the calibration found. Every key has a default.
#pragma once

#include <string>

#include "slave/vision/imaging/axes.h"
#include "slave/vision/imaging/imaging_model.h"

namespace telekerf::imaging {

struct ImagingFile {
  ImagingModel model;
  AxesModel axes = default_axes();
};

/// The unit that is simulated where no file says otherwise: pixels of 6 um, 0.05 to 0.02 mm of the workpiece
/// each.
ImagingFile default_imaging();

/// Throws StartupError that names file, key, value and bound.
ImagingFile load_imaging(const std::string& path);
/// The same from text; `name` stands in messages.
ImagingFile parse_imaging(const std::string& toml, const std::string& name);
/// What load_imaging() reads back, figure by figure.
std::string imaging_toml(const ImagingFile& file);

}  // namespace telekerf::imaging
