// SPDX-License-Identifier: Apache-2.0
// From what a user names as `imaging` to two axes. Axes of your own: a file that defines an AxesKind beside
// the class, and one row in axes_kinds.cpp.
#pragma once

#include <memory>
#include <string>

#include "common/runtime/device_registry.h"
#include "slave/vision/imaging/axes.h"
#include "slave/vision/imaging/simulated_axes.h"

namespace telekerf::imaging {

/// Axes as the imaging unit gets them.
struct AxesDevice {
  std::unique_ptr<Axes> axes;
  /// The same axes if they are simulated in this process: only then can they be moved in time, and the
  /// optics' place be known.
  SimulatedAxes* plant = nullptr;
};

/// What axes are opened with beside the rest of their name.
struct AxesNeeds {
  const AxesModel& model;
  double period_s;  ///< between two control steps
};

using AxesRegistry = DeviceRegistry<AxesDevice, const AxesNeeds&>;
using AxesKind = AxesRegistry::Kind;

/// How `imaging` may be written, one form after the other.
std::string axes_forms();
/// What is wrong with what a user wrote, and the remedy; empty: nothing.
std::string validate_axes(const std::string& axes);
/// Throws StartupError.
AxesDevice open_axes(const std::string& axes, const AxesNeeds& needs);

}  // namespace telekerf::imaging
