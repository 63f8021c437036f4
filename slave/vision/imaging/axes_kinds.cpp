// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/axes_kinds.h"

#include "common/runtime/udp.h"
#include "slave/vision/imaging/udp_axes.h"

namespace telekerf::imaging {
namespace {

AxesDevice open_simulated(std::string_view, const AxesNeeds& needs) {
  // Where they stand when they are switched on; their motors are a tenth off the model.
  auto plant = std::make_unique<SimulatedAxes>(needs.model, PerAxis{5e-3, 5e-3}, 0.1, 1);
  SimulatedAxes* const same = plant.get();
  return {std::move(plant), same};
}

AxesDevice open_udp_axes(std::string_view rest, const AxesNeeds& needs) {
  return {std::make_unique<UdpAxes>(udp_address(rest), needs.period_s), nullptr};
}

// Axes of your own: their header above, and one row.
constexpr AxesKind kKinds[] = {
    {"simulated", "simulated", no_argument, open_simulated},
    {"udp", "udp:HOST:PORT", validate_udp, open_udp_axes},
};
constexpr AxesRegistry kAxesKinds("imaging", kKinds);

}  // namespace

std::string axes_forms() { return kAxesKinds.forms(); }

std::string validate_axes(const std::string& axes) { return kAxesKinds.validate(axes); }

AxesDevice open_axes(const std::string& axes, const AxesNeeds& needs) { return kAxesKinds.open(axes, needs); }

}  // namespace telekerf::imaging
