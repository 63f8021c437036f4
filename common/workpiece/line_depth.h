// SPDX-License-Identifier: Apache-2.0
// How deep a line is that the beam draws at a speed.
#pragma once

#include "common/workpiece/beam.h"
#include "common/workpiece/material.h"

namespace telekerf::workpiece {

/// Depth times speed of a line, m^2/s: what the material's law and the source's pulses come to under a beam
/// of `power_w` in focus, where pulses overlap and nothing is cut through. 0: no pulse removes anything.
double depth_speed_m2_per_s(const Material& material, double power_w,
                            const PulsedSourceSettings& source = {});

}  // namespace telekerf::workpiece
